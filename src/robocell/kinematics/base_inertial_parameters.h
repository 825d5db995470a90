// The same chain with base (minimal) inertial parameters: W. Khalil, F. Bennis, "Symbolic
// calculation of the base inertial parameters of closed-loop robots", 1995.
//
// A part of a link's inertia does not depend on the angle of its hinge: a mass on the axis, and the
// inertia that is equal about both perpendicular axes. It is moved to the previous link; that of
// the first link goes to the base, which does not move.
#pragma once

#include "robocell/kinematics/chain_model.h"

namespace robocell::internal {

// In the result, links of hinges have neither mass, nor first moment along z, nor inertia about y.
// Mass matrix, gravity torques and inverse dynamics stay the same.
ChainModel WithBaseInertialParameters(const ChainModel& chain);

}  // namespace robocell::internal
