// Inverse kinematics for a step that has no solution nearby (ik_step.h), as beside a singularity:
// how far damped differential steps get towards a pose, with joint values near those before it.
//
//   const IkResult next = IkTowards(chain, target, commanded);
//   if (next.success) Command(next.q);  // next.position_error is what is left
#pragma once

#include <span>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/ik.h"

namespace robocell {

// Returns joint values near `from` that bring the tip as near to `tip_in_base` as damped
// differential steps (differential_ik.h) can, while no joint moves farther than LargestJointStep
// from `from`. `success` says that at least a fiftieth of the pose error is gone; the errors are
// the rest. Angles are weighed against lengths by the chain's length. Errors as in Ik. No
// allocation; less than a millisecond.
IkResult IkTowards(const Chain& chain, const Pose& tip_in_base, std::span<const double> from);

}  // namespace robocell
