// The base frame of a robot in the shared base frame of its environment, also where joints of the
// robot itself move its base: a rail, planar joints.
#pragma once

#include <optional>

#include "robocell/math/pose.h"
#include "robocell/robot/robot.h"

namespace robocell::internal {

// Returns the present pose of the robot's base in the shared base frame.
Pose BaseInSharedFrame(const Robot& robot);

// Returns how far joints can move the origin of the robot's base from where it is, m; infinite
// without limits. Unset for a base that no joint moves.
std::optional<double> BaseTravel(const Robot& robot);

}  // namespace robocell::internal
