// The reach of a chain, for a RobotConfig without `reach`.
//
//   const double metres = ApproximateReach(chain);
#pragma once

#include "robocell/kinematics/chain.h"

namespace robocell {

// Returns the largest distance (m) of the tip from the origin of the base frame that was found
// among evenly spread joint values in the limits, improved joint by joint. It is never more than
// the true reach, and usually within 1 % of it. The same chain always gives the same number. Takes
// a few milliseconds, once for all chains that move alike. Joints without limits: hinges in a turn; a slide without limits moves by at
// most the chain's length.
double ApproximateReach(const Chain& chain);

}  // namespace robocell
