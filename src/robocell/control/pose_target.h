// Private to control: the target pose of Cartesian controllers as the seven numbers that commands
// and records contain: x y z, then the quaternion xyzw, in the robot base frame.
#pragma once

#include <array>
#include <span>

#include "robocell/math/pose.h"
#include "robocell/robot/move_group.h"

namespace robocell {

using PoseNumbers = std::array<double, 7>;

PoseNumbers ToNumbers(const Pose& pose);
// Throws ArgumentError, which begins with the group's place, for a wrong number of values, values
// that are not finite and a quaternion that is not of unit length. No allocation otherwise.
Pose PoseFromNumbers(std::span<const double> numbers, const MoveGroup& group);

}  // namespace robocell
