// What the numbers of a model are measured in: joints and controls.
#pragma once

#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

// "m" for a slide, "rad" for all other joints.
std::string JointUnit(const mjModel* model, int joint);

// The unit of each control (nu), in the engine's order: of position servos "rad" or "m", of
// velocity servos "rad/s" or "m/s", of motors "N m" or "N". "actuator" where the number has a
// meaning of the actuator's own: with a gear or gain other than 1 (a gripper's 0..255), at fixed
// tendons, at sites and bodies, for muscles.
std::vector<std::string> CtrlUnits(const mjModel* model);

}  // namespace robocell::internal
