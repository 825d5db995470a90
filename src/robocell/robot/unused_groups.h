// Finds the groups of a robot that are not used where one arm and its gripper are, as in
// environments and pick tasks.
#pragma once

#include <string>

#include "robocell/robot/robot.h"

namespace robocell {

// Says which groups of kind arm and gripper are used, its first arm and the gripper of that
// (Robot::gripper_of()), and which are not: "arm 'left' and gripper 'lgrip' are used; 'right' and
// 'rgrip' hold still". "" for a robot without others.
std::string TellUnusedGroups(const Robot& robot);

}  // namespace robocell
