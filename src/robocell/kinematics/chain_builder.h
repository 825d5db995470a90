// Reads a chain out of a compiled model. Used by Chain's constructor only; see chain.h for meaning
// and errors.
#pragma once

#include <string_view>
#include <vector>

#include "robocell/kinematics/chain.h"
#include "robocell/mujoco/forward.h"

namespace robocell {

struct BuiltChain {
  ChainModel model;
  std::vector<ChainJoint> joints;
};

// Names in full, without the options' prefix.
BuiltChain BuildChain(const mjModel* model, std::string_view base_body, const ChainTip& tip,
                      const ChainOptions& options);

}  // namespace robocell
