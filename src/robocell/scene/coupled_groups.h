// Private to scene: joints that follow others (mujoco/couplings.h) in the configuration of robots.
#pragma once

#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/scene/compile_log.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

// Leaves joints that follow others of the same arm out of its `joints`, `home` and `home_noise`,
// and notes it. Warns of a `home` of any group that contradicts its couplings.
void DropFollowers(const mjModel* model, std::vector<RobotRecord>& robots, CompileLog& log);

// Returns the numbers of a robot's joints in the model; -1 for one that is not there.
std::vector<int> JointIds(const mjModel* model, const RobotRecord& robot, const NameList& joints);

// Returns "'b' follows 'a'" for each follower among the joints of these names.
std::vector<std::string> DescribeFollowers(const std::vector<ListedFollower>& followers,
                                           const NameList& joints);

}  // namespace robocell::internal
