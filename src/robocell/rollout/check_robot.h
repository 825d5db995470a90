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

// Adds the problems at the paths of the configuration's fields: arms and grippers without a
// controller, names that no record can have, a file that its model contradicts (check_config.h).
// Returns false if there are any. The robot's scene does not change.
bool CheckRobot(const Robot& robot, Problems& problems);

}  // namespace robocell
