// One inverse kinematics query in all lanes: each searches from its own start.
//
// A seed near the target searches alone for its first steps, because one lane is cheaper than
// several. If it is far or slow, others join it, but a solution from the seed takes precedence
// until the seed is given up. Otherwise the first lane to arrive has the solution (of several, the
// one that began first). The same query has the same solution on the same instruction set.
#pragma once

#include "robocell/kinematics/ik.h"

namespace robocell::internal {

// options.prefer and options.filter have no meaning here. iterations: steps, each of all lanes at
// once. `poll` may be empty; it is called every so many starts.
IkResult SearchInLanes(const Chain& chain, const Transform& tip_in_base, const IkOptions& options,
                       const std::function<void()>& poll);

}  // namespace robocell::internal
