// Private to scene: proposes position servos for joints that no actuator moves, from the inertia
// that they move.
//
//   const ServoProposal servo = ProposeServo(model, joint);
//   AddServo(spec, "shoulder", servo);
#pragma once

#include <array>
#include <optional>
#include <string>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

struct ServoProposal {
  double kp = 0, kv = 0;
  double armature = 0;                               // to add to a joint that has none; 0: keep
  std::optional<std::array<double, 2>> ctrl_range;   // of a limited joint
  std::optional<std::array<double, 2>> force_range;  // of a joint with limited actuator forces
};

// Returns a critically damped servo for a hinge or slide. It is as stiff as a spring with which the
// largest inertia that the joint moves, over poses spread over the joints' ranges and with the
// joints that follow it, swings with 25 rad/s; the slides of fingers with 60 rad/s, and they push
// with at least 30 N at half their travel. It is stiffer where the weight of what the joint moves
// would pull it more than 5 mrad (0.5 mm) off, up to 250 rad/s.
ServoProposal ProposeServo(const mjModel* model, int joint);

// Adds the servo, named after the joint.
void AddServo(mjSpec* spec, const std::string& joint, const ServoProposal& servo);

}  // namespace robocell::internal
