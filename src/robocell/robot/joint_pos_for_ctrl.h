// Private to robot and env: the configuration that servos hold together.
#pragma once

#include <span>

#include "robocell/robot/move_group.h"

namespace robocell::internal {

// Computes the joint positions at which the servos of an arm rest with their present controls, for
// arms whose actuators act together (scene/drive_matrix.h). `q` begins near them. Returns false, and
// leaves `q`, if the group has other actuators.
bool JointPosForCtrl(const MoveGroup& group, std::span<double> q);

}  // namespace robocell::internal
