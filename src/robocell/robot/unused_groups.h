// Finds what of a robot is not used: groups, where one arm and its gripper are driven (environments,
// pick tasks), and actuators that no group commands.
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"

namespace robocell::internal {

// Says which groups of kind arm and gripper are used, its first arm and the gripper of that
// (Robot::gripper_of()), and which are not: "arm 'left' and gripper 'lgrip' are used; 'right' and
// 'rgrip' hold still". "" for a robot without others.
std::string TellUnusedGroups(const Robot& robot);

// The actuators that belong to no move group, so that nothing will ever command them: mostly a group
// was forgotten in the robot's file. Names without the robot's prefix. Those of other parts of the scene do not count, nor those
// that were added for the robot's controllers.
std::vector<std::string> IdleActuators(const Robot& robot);

}  // namespace robocell::internal
