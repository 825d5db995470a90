// Private to robot: actuators that belong to no move group, so that nothing will ever command them.
// Mostly a group was forgotten in the robot's file.
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"

namespace robocell {

// Their names without the robot's prefix. Those of other parts of the scene do not count, nor those
// that were added for the robot's controllers.
std::vector<std::string> IdleActuators(const Robot& robot);

}  // namespace robocell
