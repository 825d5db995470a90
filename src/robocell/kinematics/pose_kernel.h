// Kinematics and dynamics of many configurations of one chain: every lane of a vector register
// works on its own configuration, with the widest registers of this processor.
//
// Lanes never mix, so that a result does not depend on its neighbours. Instruction sets round
// differently. For a single configuration link_kernel.h is faster.
//
// Plain numbers only; this header is included by code for every instruction set.
#pragma once

#include <cstddef>

#include "robocell/kinematics/pose_table.h"

namespace robocell::internal {

// Numbers of each configuration, one configuration after the other. With a stride of 0 the first
// ones apply to all.
struct PoseRows {
  const double* data = nullptr;
  std::size_t stride = 0;
};

enum class PosePart {
  kTip,            // 4 x 4 each, row by row
  kJacobian,       // 6 x n each, row by row, linear rows first
  kGravity,        // n each
  kMass,           // n x n each, row by row
  kMotion,         // n each
  kManipulability  // 1 each
};

// The inputs that the part needs: joint values n each, gravity in the base frame 3 each.
struct PoseQuery {
  std::size_t count = 0;
  PoseRows q, qd, qdd, gravity;
};

// With Jacobians, computes tips too if they are requested.
void ComputePoses(const PoseTable& table, PosePart part, const PoseQuery& query, double* out,
                  double* tips = nullptr);

}  // namespace robocell::internal
