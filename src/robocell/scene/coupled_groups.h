// Private to scene: joints of arms that follow others (mujoco/couplings.h) in the configuration of
// robots and in keyframes.
#pragma once

#include <vector>

#include "robocell/mujoco/forward.h"
#include "robocell/scene/compile_log.h"
#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Leaves joints that follow others of the same arm out of its `joints`, `home` and `home_noise`,
// and says so. Warns of a home that contradicts the coupling.
void DropFollowers(const mjModel* model, std::vector<RobotRecord>& robots, CompileLog& log);

// Puts all joints that follow those of an arm where these have them.
void PlaceFollowers(const mjModel* model, const RobotRecord& robot, const MoveGroupConfig& group,
                    double* qpos);

}  // namespace robocell::internal
