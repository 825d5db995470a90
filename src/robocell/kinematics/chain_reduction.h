// Reduces a chain in which joints follow others to its degrees of freedom. Only for code that makes
// a Chain; see chain.h for meaning and errors.
#pragma once

#include <string>

#include "robocell/kinematics/chain_builder.h"

namespace robocell::internal {

// Does nothing if no joint of the chain follows another one of it. A joint that is coupled to
// joints outside of the chain alone leads itself; several that follow one outside are led by the
// first of them. `place` begins messages.
void ReduceChain(const mjModel* model, const std::string& place, BuiltChain* chain);

}  // namespace robocell::internal
