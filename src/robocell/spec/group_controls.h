// Which controllers a move group can have, by the group's kind. An arm can have all of them, as far
// as its actuators go; the others are driven by position servos only, and a gripper only by its
// opening.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robocell/spec/robot_config.h"

namespace robocell::internal {

std::vector<ControlKind> ControlsOf(MoveGroupKind group);

// "a gripper", "an arm", "a base" or "a generic group", for messages.
const char* WithArticle(MoveGroupKind group);

// Why a group of this kind cannot have the controller of that name, with those that it can have;
// "" when it can. Controllers that users registered are not known here: "".
std::string WhyNotControlledBy(MoveGroupKind group, std::string_view controller);

}  // namespace robocell::internal
