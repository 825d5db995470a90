// The result of link_kernel.h, for the other code of this folder.
#pragma once

#include "robocell/kinematics/link_kernel.h"
#include "robocell/kinematics/transform.h"

namespace robocell::internal {

// Returns the tip in the base frame from a result that includes it.
inline Transform TipOf(const LinkAnswer& answer) {
  Transform tip;
  for (int c = 0; c < 3; ++c)
    tip.rotation.col(c) = Eigen::Map<const Eigen::Vector3d>(answer.tip[c]);
  tip.translation = Eigen::Map<const Eigen::Vector3d>(answer.tip[3]);
  return tip;
}

}  // namespace robocell::internal
