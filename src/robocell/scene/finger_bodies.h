// Private to scene: finds the bodies of a gripper's fingers, and what drives them.
#pragma once

#include <mujoco/mujoco.h>

#include <vector>

#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Returns the bodies that `fingers` names, two or more, else those of the group's two joints; none
// if one is unknown. The same body may occur twice.
std::vector<int> FingerBodies(const mjModel* model, const RobotRecord& robot,
                              const MoveGroupConfig& gripper);

// Returns the lowest body that carries all of these, which are not none.
int HandOf(const mjModel* model, const std::vector<int>& fingers);

// Marks the degrees of freedom (nv) of the hand and of what carries it that drive its fingers
// through equalities: a slider that the fingers hang on, and whose joint their joints follow, or
// links between the fingers and a part behind the slider.
std::vector<bool> DofsThatDriveFingers(const mjModel* model, int hand);

}  // namespace robocell::internal
