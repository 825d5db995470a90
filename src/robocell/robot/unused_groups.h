// Finds unused parts of a robot: groups, where one arm and its gripper are driven (environments,
// pick tasks), and actuators that no group commands.
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"

namespace robocell::internal {

// Lists the used groups of kind arm and gripper, which are its first arm and that arm's gripper
// (Robot::gripper_of()), and the unused ones: "arm 'left' and gripper 'lgrip' are used; 'right' and
// 'rgrip' hold still". "" for a robot without others.
std::string DescribeUnusedGroups(const Robot& robot);

// Returns the actuators that belong to no move group, so that nothing will ever command them;
// usually a group is missing in the robot's file. Names are without the robot's prefix. Actuators
// of other parts of the scene do not count, nor those that were added for the robot's controllers.
std::vector<std::string> IdleActuators(const Robot& robot);

}  // namespace robocell::internal
