// The limits that a group tells, as whoever keeps to them may use them.
#pragma once

#include <vector>

#include "robocell/robot/move_group.h"

namespace robocell {

// joint_pos_limits(): one rising interval for each of the group's nq() positions. ArgumentError
// with the group's place for anything else, which groups of the user's own may give: a missing one
// would be a joint without limits.
std::vector<Interval> CheckedJointPosLimits(const MoveGroup& group);

}  // namespace robocell
