// Where one arm and its gripper are used, as in environments and pick tasks, a robot of several
// has others that are not.
#pragma once

#include <string>

#include "robocell/robot/robot.h"

namespace robocell {

// Says which groups of kind arm and gripper are used, its first arm and the gripper of that
// (Robot::gripper_of()), and which are not: "arm 'left' and gripper 'lgrip' are used; 'right' and
// 'rgrip' hold still". "" for a robot without others.
std::string TellUnusedGroups(const Robot& robot);

}  // namespace robocell
