// Private to scene: finds the bodies of a gripper's two fingers.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <optional>

#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Returns the bodies that `fingers` names, else those of the group's two joints; unset if they are
// unknown. Both may be the same body.
std::optional<std::array<int, 2>> FingerBodies(const mjModel* model, const RobotRecord& robot,
                                               const MoveGroupConfig& gripper);

}  // namespace robocell::internal
