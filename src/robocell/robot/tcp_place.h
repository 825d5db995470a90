// Whether an arm's TCP is where its gripper holds things. A site of another unit or on another body
// goes unnoticed otherwise: what is picked up is picked up all the same, and the poses and twists
// that a dataset records are those of a point where nothing is.
#pragma once

#include <optional>
#include <string>

#include "robocell/robot/robot.h"

namespace robocell {

// What to tell of a TCP farther than 0.15 m, and than the fingers are apart, from both fingers of
// the arm's gripper in the present state; nothing of arms without such a gripper.
// ArgumentError when the group is no arm.
std::optional<std::string> TellTcpFarFromFingers(const Robot& robot, const MoveGroup& arm);

}  // namespace robocell
