// One inverse kinematics question in all lanes: each searches from a start of its own.
//
// With a seed the first steps are the seed's alone, so that a target near it is answered near it;
// then, or without a seed, the first lane to arrive has the answer (of several, the one that began
// first). The same question has the same answer on the same instruction set.
#pragma once

#include "robocell/kinematics/ik.h"

namespace robocell {

// options.prefer and options.filter have no meaning here. iterations: steps, each of all lanes at
// once.
IkResult SearchInLanes(const Chain& chain, const Transform& tip_in_base, const IkOptions& options);

}  // namespace robocell
