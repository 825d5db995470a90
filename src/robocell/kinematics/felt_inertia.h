// The same chain with as few numbers of its links as its joints can feel: W. Khalil, F. Bennis,
// "Symbolic calculation of the base inertial parameters of closed-loop robots", 1995.
//
// Some of a link looks the same however its hinge turns: a mass on the axis, and as much of the
// inertia about both axes across. That might as well belong to the link before, and of the first
// link to the base, which does not move.
#pragma once

#include "robocell/kinematics/chain_model.h"

namespace robocell {

// Links of hinges have neither mass, nor moment along z, nor inertia about y. Mass matrix, torques
// of gravity and inverse dynamics stay what they are.
ChainModel WithFeltInertias(const ChainModel& chain);

}  // namespace robocell
