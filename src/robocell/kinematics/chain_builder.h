// Reads a chain out of a compiled model. For Chain's makers only; see chain.h for meaning and
// errors.
#pragma once

#include <string_view>
#include <vector>

#include "robocell/kinematics/chain.h"
#include "robocell/mujoco/forward.h"

namespace robocell::internal {

struct BuiltChain {
  ChainModel model;
  std::vector<ChainJoint> joints;
  std::vector<JointCoupling> couplings;
};

// Names in full, without the options' prefix.
BuiltChain BuildChain(const mjModel* model, std::string_view base_body, const ChainTip& tip,
                      const ChainOptions& options);

// Fills reach_bound and length. Straightens the chain out in thought: no pose reaches farther than
// the sum of its parts.
void MeasureLength(ChainModel* chain);

}  // namespace robocell::internal
