// Units of the numbers of a model: joints and controls.
#pragma once

#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

// Returns "m" for a slide, "rad" for all other joints.
std::string JointUnit(const mjModel* model, int joint);

// Returns the unit of each control (nu), in the engine's order: "rad" or "m" for position servos,
// "rad/s" or "m/s" for velocity servos, "N m" or "N" for motors. "actuator" where the number has a
// meaning of the actuator's own: with a gear or gain other than 1 (a gripper's 0..255), at fixed
// tendons, at sites and bodies, for muscles.
std::vector<std::string> CtrlUnits(const mjModel* model);

}  // namespace robocell::internal
