// Private to scene: which bodies of a model are the two fingers of a gripper.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <optional>

#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// The bodies that `fingers` names, else those of the group's two joints; nothing when it is not
// known which they are. Both may be the same body.
std::optional<std::array<int, 2>> FingerBodies(const mjModel* model, const RobotRecord& robot,
                                               const MoveGroupConfig& gripper);

}  // namespace robocell::internal
