// What a robot and its file need for everything that uses one: `robocell check`,
// `validate_robot` in Python, and every run. What one of them refuses, the others refuse too.
//
//   Problems problems(robot.config().locations);
//   ValidateRobot(robot, problems);
//   problems.Throw("robot 'rc7'");
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/spec/problems.h"

namespace robocell {

// Adds what is wrong, at the paths of the configuration's fields: arms and grippers without a
// controller, names that no record can have, a file that its model contradicts (validate_config.h).
// False when there is something. The robot's scene is not changed.
bool ValidateRobot(const Robot& robot, Problems& problems);

}  // namespace robocell
