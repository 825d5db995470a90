// The range in which solvers and samplers of this folder start a joint: its limits, or a sensible
// range without limits.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robocell/kinematics/chain_model.h"

namespace robocell::internal {

struct StartRange {
  double lower = 0, upper = 0;

  double middle() const { return 0.5 * (lower + upper); }
  double at(double part) const { return lower + part * (upper - lower); }  // part in [0, 1]
};

// Hinges start within one turn, because further turns repeat it; slides without limits within
// `length` of their reference position. A joint with one limit starts in a range of the same size,
// shifted to obey it.
inline StartRange StartRangeOf(const JointModel& joint, double length) {
  const bool limited = std::isfinite(joint.lower) && std::isfinite(joint.upper);
  const double middle = limited       ? 0.5 * (joint.lower + joint.upper)
                        : joint.slide ? joint.reference
                                      : 0;
  double half = limited       ? 0.5 * (joint.upper - joint.lower)
                : joint.slide ? length
                              : std::numbers::pi;
  if (!joint.slide) half = std::min(half, std::numbers::pi);
  const StartRange range{middle - half, middle + half};
  if (limited) return range;
  const double moved =
      std::max(0.0, joint.lower - range.lower) + std::min(0.0, joint.upper - range.upper);
  return {range.lower + moved, range.upper + moved};
}

}  // namespace robocell::internal
