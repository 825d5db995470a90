// Reads a chain from a compiled model. Only for code that makes a Chain; see chain.h for meaning
// and errors.
#pragma once

#include <string_view>
#include <vector>

#include "robocell/kinematics/chain.h"
#include "robocell/mujoco/forward.h"

namespace robocell::internal {

struct BuiltChain {
  ChainModel model;
  std::vector<ChainJoint> joints;
  std::vector<JointCoupling> couplings{};
  std::vector<ChainFollower> followers{};
  std::vector<ChainJoint> link_joints{};  // with followers
};

// Names are full names, without the options' prefix.
BuiltChain BuildChain(const mjModel* model, std::string_view base_body, const ChainTip& tip,
                      const ChainOptions& options);

// Fills reach_bound and length. The bound is that of the stretched chain: no pose reaches farther
// than the sum of its parts.
void MeasureLength(ChainModel* chain);

}  // namespace robocell::internal
