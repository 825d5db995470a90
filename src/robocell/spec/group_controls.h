// The controllers that a move group can have, by the group's kind. An arm can have all of them that
// its actuators allow; the others are driven by position servos only, and a gripper only by its
// opening.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robocell/spec/robot_config.h"

namespace robocell::internal {

std::vector<ControlKind> ControlsOf(MoveGroupKind group);

// Returns the kind with its article for messages: "a gripper", "an arm", "a base" or "a generic
// group".
const char* WithArticle(MoveGroupKind group);

// Returns why a group of this kind cannot have the named controller, with those that it can have;
// "" if it can. Controllers that users registered are not known here: "".
std::string WhyNotControlledBy(MoveGroupKind group, std::string_view controller);

}  // namespace robocell::internal
