// Actuators and joints that two move groups of a robot share although both are commanded: what the
// one sends the other overwrites, and a dataset has actions that never acted. A group without
// actuators may list joints of others (to be locked for inverse kinematics, or read).
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

// At the field of the group that comes later, so far as it says it.
struct SharedParts {
  std::string field;  // "move_groups.wrist.actuators[0]"
  std::string message;
};

// One entry for each two groups that share something.
std::vector<SharedParts> FindSharedParts(const std::vector<GroupParts>& groups);

}  // namespace robocell::internal
