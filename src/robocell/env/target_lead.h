// Limits how far a target may lead an arm: takes back the part of a command that the arm does not
// carry out because something blocks it. Pure functions of targets and states; the driver of an arm
// (arm_driver.h) stores the pending part.
//
//   PendingMove pending;                                  // what was sent and is not carried out
//   AddMove(pending, before, sent);
//   sent = WithinLead(sent, {last_tcp, tcp, held_by, led_by}, lead, pending);
//
// Only the pending part is taken back, and only along its own direction: a tool that is pressed
// onto a table is not turned away or moved aside because the arm gives way there, and an arm that
// sags under a load keeps its target. The lag of a fast arm behind its target stays pending: it
// becomes lead at the moment at which something stops the arm. So does a motion against the pending
// direction, by which something pushes the arm away.
//
// An action against the lead reduces it by its own size: an arm that is pressed onto something
// leaves with the first action back, and small actions still let go little by little.
#pragma once

#include <span>

#include "robocell/env/env_state.h"
#include "robocell/math/pose.h"
#include "robocell/spec/env_action.h"

namespace robocell::internal {

// Adds the move from one pose to another.
void AddMove(PendingMove& move, const Pose& from, const Pose& to);

// The position of an arm, or of a joint, at the last command and now, to be compared with its
// target; and the targets under which it would stay there, as it sags, and under which it would
// continue its motion, as it lags.
template <typename T>
struct Led {
  T before, present, rest, steady;
};

// Returns `sent` less the part of `pending` by which it leads the arm by more than `lead`, reduced
// by the part of `action` against it, along the direction of `pending`. The arm counts as anywhere
// between its `present` position and those of `rest` and `steady`, along each axis. `pending`
// becomes the remaining part: at most the target's lead over the arm at rest. `action` is the next
// one.
Pose WithinLead(const Pose& sent, const Led<Pose>& led, const StepLimit& lead, PendingMove& pending,
                const PendingMove& action = {});

// Limits the lead of a joint, as WithinLead does for a pose.
double WithinJointLead(double sent, const Led<double>& led, double lead, double& pending,
                       double action = 0);

// Limits the leads of the joints of an arm that follow poses, each with its own: the same share of
// the pending part is taken back from all of them, which keeps the direction of the TCP's lead, and
// the TCP itself where joints lead in the null space only. Returns true if it took anything back.
bool TakeBackJoints(std::span<double> sent, std::span<const Led<double>> led,
                    std::span<const double> leads, std::span<double> pending);

}  // namespace robocell::internal
