// Poses for arms of fewer than six degrees of freedom, which can take few of them: the position is
// reached, and the rotation as nearly as the joints that are left allow.
//
//   IkResult found = IkStep(chain, target, commanded);
//   if (!found.success && HasFewJoints(chain)) found = IkPositionFirst(chain, target, commanded);
//   // found.rotation_error remains
#pragma once

#include <span>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/ik.h"

namespace robocell::internal {

// Returns true for fewer than six degrees of freedom.
bool HasFewJoints(const Chain& chain);

// Returns joint values that bring the tip to the position of `tip_in_base` (within the default
// tolerance of Ik) with the nearest rotation, in the neighbourhood of `from` where that has one: it
// descends from there, and otherwise from a solution of the position alone, unless a joint would
// move farther than LargestJointStep (ik_step.h). Method: Gauss-Newton
// steps for the position, and for the rotation in their null space, without the joints that press
// on a limit. `success`: the position is reached; `rotation_error` is the rest of the rotation.
// Throws the errors of Ik. For chains of fewer than six degrees of freedom.
IkResult IkPositionFirst(const Chain& chain, const Pose& tip_in_base, std::span<const double> from);

}  // namespace robocell::internal
