// One inverse kinematics question in all lanes: each searches from a start of its own.
//
// A seed near the target searches alone for its first steps: one lane is cheaper than several.
// Where it is far or slow others join it, but it has the last word until it is given up: what can
// be answered from the seed alone is answered so. Otherwise the first lane to arrive has the answer
// (of several, the one that began first). The same question has the same answer on the same
// instruction set.
#pragma once

#include "robocell/kinematics/ik.h"

namespace robocell::internal {

// options.prefer and options.filter have no meaning here. iterations: steps, each of all lanes at
// once. `poll` may be empty; it is called every so many starts.
IkResult SearchInLanes(const Chain& chain, const Transform& tip_in_base, const IkOptions& options,
                       const std::function<void()>& poll);

}  // namespace robocell::internal
