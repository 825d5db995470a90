// The step from one joint axis to the next along their common normal (J. Denavit and R. S.
// Hartenberg, "A Kinematic Notation for Lower-Pair Mechanisms", 1955).
#pragma once

#include <optional>

#include "robocell/kinematics/transform.h"

namespace robocell {

// A transform between frames whose z axes are the joints' axes, as: turn by angle_before about and
// shift by shift_before along the old axis, along the normal (then the x axis) by `length` and
// about it by the twist, shift and turn along and about the new axis. rad, m.
struct CommonNormal {
  double angle_before = 0, shift_before = 0;
  double length = 0, cos_twist = 1, sin_twist = 0;
  double angle_after = 0, shift_after = 0;
};

// Nothing for axes that are nearly, but not exactly, parallel: their normal is far away, where
// digits are lost.
std::optional<CommonNormal> CommonNormalOf(const Transform& step);

}  // namespace robocell
