// The same chain in frames whose steps are as few numbers as possible, for kernels that handle many
// configurations at once.
//
// A joint's frame may be turned about and shifted along the joint's axis. Here the x axis is the
// common normal with the next axis, and the rest of an angle is in the reference of a hinge: a
// step is (length, 0, shift) and a twist about x. Not so where two axes are nearly parallel
// (common_normal.h), at the first joint, and at slides, which keep an angle in their step.
#pragma once

#include "robocell/kinematics/chain_model.h"

namespace robocell {

// Tip, axes, inertias and joint values mean the same.
ChainModel InNormalFrames(const ChainModel& chain);

}  // namespace robocell
