// How far a chain reaches: for RobotConfig.reach when the file does not say it.
//
//   const double metres = ApproximateReach(chain);
#pragma once

#include "robocell/kinematics/chain.h"

namespace robocell {

// The largest distance (m) of the tip from the origin of the base frame that was found among evenly
// spread joint values in the limits, improved joint by joint. Never more than the truth, and mostly
// within 1 % of it. The same chain always gives the same number. Takes a few milliseconds. Joints
// without limits: hinges in a turn; a slide without limits moves by at most the chain's length.
double ApproximateReach(const Chain& chain);

}  // namespace robocell
