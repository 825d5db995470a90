// Positions of joints that equality constraints couple (couplings.h, closed_loops.h): moves them
// together.
#pragma once

#include <span>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

// Moves all joints that follow one another with those of the list to where these have them. A joint
// of the list that its mechanism cannot follow (held in place, by a polynomial that bends, or behind
// another joint of the list) moves back to where the others have it. Leaves joints alone whose
// couplings cannot be composed. Joints of -1 are left out.
void PlaceFollowers(const mjModel* model, std::span<const int> joints, double* qpos);

// Moves the hinges and slides of the list by `offsets`, and all joints coupled with them, so that
// they satisfy the constraints. Stops at the limits of each of them. These stay where they are:
// mechanisms of which no joint is moved or that have no position inside all limits, joints that a
// constraint holds, and joints whose couplings cannot be composed. Loops (closed_loops.h) close by
// their other joints; if one cannot, all move by a smaller share of the offsets.
void MoveCoupled(const mjModel* model, std::span<const int> joints, std::span<const double> offsets,
                 double* qpos);

}  // namespace robocell::internal
