// What is asked of a robot and its file by everything that uses one: `robocell check`,
// `check_config`, and every run. What one of them refuses, the others refuse too.
//
//   Problems problems(robot.config().locations);
//   CheckRobot(robot, problems);
//   problems.Throw("robot 'rc7'");
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/spec/problems.h"

namespace robocell {

// Adds what is wrong, at the paths of the configuration's fields: arms and grippers without a
// controller, names that no record can have, a file that its model contradicts (check_config.h).
// False when there is something. The robot's scene is not changed.
bool CheckRobot(const Robot& robot, Problems& problems);

// The same of what the scripted expert of pick tasks needs beyond that, of a robot that passed
// CheckRobot: a base that can be put where the objects are in reach, an arm that takes joint
// positions, a gripper with fingers. `options` and `timestep` are the run's.
bool CheckScriptedExpert(const Robot& robot, const SimOptions& options, double timestep,
                         Problems& problems);

// That as texts, for a robot of which nobody has said what it is for. Empty when pick tasks can use
// it.
std::vector<std::string> WhyNoPicks(const Robot& robot);

}  // namespace robocell
