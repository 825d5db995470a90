// What is to each joint of a chain as much as a radian is to a hinge. For the solvers of this
// folder, that weigh joints against each other.
#pragma once

#include "robocell/kinematics/chain_model.h"

namespace robocell {

// Of a slide the chain's length, m.
inline double UnitOf(const ChainModel& chain, int joint) {
  return chain.joints[joint].slide ? chain.length : 1;
}

}  // namespace robocell
