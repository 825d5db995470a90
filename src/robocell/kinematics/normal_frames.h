// The same chain in frames whose steps have as few numbers as possible, for kernels that handle
// many configurations at once.
//
// A joint's frame may be turned about and shifted along the joint's axis. Here the x axis is the
// common normal with the next axis, and the rest of an angle is in the reference of a hinge: a step
// is (length, 0, shift) and a twist about x. Exceptions are nearly parallel axes (CommonNormalOf),
// the first joint, and slides, which keep an angle in their step.
#pragma once

#include <optional>

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/transform.h"

namespace robocell::internal {

// Tip, axes, inertias and joint values keep their meaning.
ChainModel InNormalFrames(const ChainModel& chain);

// The step from one joint axis to the next along their common normal (J. Denavit and R. S.
// Hartenberg, "A Kinematic Notation for Lower-Pair Mechanisms", 1955).
//
// A transform between frames whose z axes are the joints' axes, composed of: turn by angle_before
// about and shift by shift_before along the old axis, along the normal (then the x axis) by
// `length` and about it by the twist, shift and turn along and about the new axis. rad, m.
struct CommonNormal {
  double angle_before = 0, shift_before = 0;
  double length = 0, cos_twist = 1, sin_twist = 0;
  double angle_after = 0, shift_after = 0;
};

// Unset for axes that are nearly, but not exactly, parallel: their normal is far away, where digits
// are lost.
std::optional<CommonNormal> CommonNormalOf(const Transform& step);

}  // namespace robocell::internal
