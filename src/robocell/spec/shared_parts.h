// Finds actuators and joints that two commanded move groups of a robot share: each group overwrites
// the other's commands, and a dataset would contain actions that never took effect. A group without
// actuators may list joints of others (to lock them for inverse kinematics, or to read them).
#pragma once

#include <string>
#include <vector>

namespace robocell::internal {

// The elements of a group. An arm that names no actuators has those of its joints.
struct GroupParts {
  std::string name = {};
  std::vector<std::string> joints = {}, actuators = {};
  bool names_actuators = true;
};

// A shared element, at the field of the later group if that group names it.
struct SharedParts {
  std::string field;  // "move_groups.wrist.actuators[0]"
  std::string message;
};

// Returns one entry for each two groups that share something.
std::vector<SharedParts> FindSharedParts(const std::vector<GroupParts>& groups);

}  // namespace robocell::internal
