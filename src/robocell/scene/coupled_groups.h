// Private to scene: joints of arms that follow others (mujoco/couplings.h) in the configuration of
// robots and in keyframes.
#pragma once

#include <span>
#include <vector>

#include "robocell/mujoco/forward.h"
#include "robocell/scene/compile_log.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

// Leaves joints that follow others of the same arm out of its `joints`, `home` and `home_noise`,
// and says so. Warns of a home that contradicts the coupling.
void DropFollowers(const mjModel* model, std::vector<RobotRecord>& robots, CompileLog& log);

// Returns the numbers of a robot's joints in the model; -1 for one that is not there.
std::vector<int> JointIds(const mjModel* model, const RobotRecord& robot, const NameList& joints);

// Puts all joints that follow those of an arm where these have them; `joints` are the group's.
void PlaceFollowers(const mjModel* model, const MoveGroupConfig& group, std::span<const int> joints,
                    double* qpos);

}  // namespace robocell::internal
