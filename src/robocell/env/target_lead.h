// How far a target may lead an arm: takes back what an arm was sent and did not carry out, as it
// does behind what blocks it. Pure functions of targets and states; the driver of an arm
// (arm_driver.h) remembers what is pending.
//
//   PendingMove pending;                                  // what was added to the target since it
//   pending.Add(before, sent);                            // last was near the arm
//   sent = WithinLead(sent, steady, present, lead, pending);
//
// Only what is pending is taken back, and only along its own direction: a tool that is pressed onto
// a table is not turned away or moved aside because it gives way there, and an arm that sags under
// a load keeps its target.
#pragma once

#include <array>

#include "robocell/math/pose.h"
#include "robocell/spec/env_action.h"

namespace robocell {

// The sum of the moves of a target: metres, and a rotation vector, along the axes of the poses.
struct PendingMove {
  std::array<double, 3> shift = {}, turn = {};
  void Add(const Pose& from, const Pose& to);
};

// `sent` without that part of `pending` by which it leads the arm by more than `lead`; the rest
// stays pending, none where the arm is within the lead. `present` is where the arm is, `steady` the
// target under which it would go on as it does: the arm counts as where it is nearer of the two.
Pose WithinLead(const Pose& sent, const Pose& steady, const Pose& present, const StepLimit& lead,
                PendingMove& pending);

// The same for a joint; it counts as anywhere between `steady` and `present`.
double WithinJointLead(double sent, double steady, double present, double lead, double& pending);

}  // namespace robocell
