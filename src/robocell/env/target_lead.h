// How far a target may lead an arm: takes back what an arm was sent and does not carry out, as it
// does behind what blocks it. Pure functions of targets and states; the driver of an arm
// (arm_driver.h) remembers what is pending.
//
//   PendingMove pending;                                  // what was sent and is not carried out
//   pending.Add(before, sent);
//   sent = WithinLead(sent, {last_tcp, tcp, held_by, led_by}, lead, pending);
//
// Only what is pending is taken back, and only along its own direction: a tool that is pressed onto
// a table is not turned away or moved aside because it gives way there, and an arm that sags under
// a load keeps its target. What a fast arm lags behind its target stays pending: it is lead from
// the moment at which something stops the arm. So is what the arm moves against what is pending:
// then something pushes it away.
//
// An action against the lead reduces it by as much as it asks for: so an arm that is pressed onto
// something leaves with the first action back, and small actions still let go little by little.
#pragma once

#include <array>
#include <span>

#include "robocell/math/pose.h"
#include "robocell/spec/env_action.h"

namespace robocell {

// The sum of the moves of a target: metres, and a rotation vector, along the axes of the poses.
struct PendingMove {
  std::array<double, 3> shift = {}, turn = {};
  void Add(const Pose& from, const Pose& to);
};

// Where an arm, or a joint, was when it was last sent something and is, to be compared with its
// target; and the targets under which it would stay there, as it sags, and under which it would go
// on moving as it does, as it lags.
template <typename T>
struct Led {
  T before, present, rest, steady;
};

// `sent` without that part of `pending` by which it leads the arm by more than `lead`, less what
// `action` goes against it, along the direction of `pending`. The arm counts as anywhere from where
// it is `present` to where it is at `rest` and `steady`, along each axis. `pending` becomes what is
// still pending: no more than by what the target leads the arm at rest. `action` is what comes next.
Pose WithinLead(const Pose& sent, const Led<Pose>& led, const StepLimit& lead, PendingMove& pending,
                const PendingMove& action = {});

// The same for a joint.
double WithinJointLead(double sent, const Led<double>& led, double lead, double& pending,
                       double action = 0);

// The same for the joints of an arm that follow poses, each with its own lead: all of them are taken
// back by the same share of what is pending, which keeps the direction of the TCP's lead, and the
// TCP itself where joints lead in the null space only. Returns whether it took anything back.
bool TakeBackJoints(std::span<double> sent, std::span<const Led<double>> led,
                    std::span<const double> leads, std::span<double> pending);

}  // namespace robocell
