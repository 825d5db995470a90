// Compares the common parts of searches with exhaustive search.
#include "robocell/kinematics/ik_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robocell/base/rng.h"

namespace robocell::internal {
namespace {

// Tries all whole turns within the limits.
double NearestByTrying(const FoldedJoint& joint, double seed, double q) {
  double nearest = q;
  for (int turns = -12; turns <= 12; ++turns) {
    const double moved = q + turns * kTurn;
    if (moved < joint.lower || moved > joint.upper) continue;
    if (std::abs(moved - seed) < std::abs(nearest - seed)) nearest = moved;
  }
  return nearest;
}

TEST(UnwindTowards, ChoosesTheNearestTurnWithinTheLimits) {
  Rng rng = Rng::Stream(1, "unwind");
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  FoldedChain chain;
  chain.n = 1;
  FoldedJoint& joint = chain.joints[0];
  int moved = 0;
  for (int k = 0; k < 20000; ++k) {
    joint.lower = k % 7 == 0 ? -kInfinity : rng.Uniform(-20, 5);
    joint.upper = k % 5 == 0 ? kInfinity : std::max(joint.lower, -20.0) + rng.Uniform(0, 25);
    const double low = std::max(joint.lower, -15.0), high = std::min(joint.upper, 15.0);
    if (low > high) continue;
    const double seed = rng.Uniform(low, high), before = rng.Uniform(low, high);
    JointVector q{before};
    UnwindTowards(chain, JointVector{seed}, {}, &q);
    const double nearest = NearestByTrying(joint, seed, before);
    EXPECT_NEAR(std::abs(q[0] - seed), std::abs(nearest - seed), 1e-9)
        << before << " to " << seed << " in " << joint.lower << " to " << joint.upper;
    EXPECT_GE(q[0], joint.lower);
    EXPECT_LE(q[0], joint.upper);
    moved += q[0] != before;
  }
  EXPECT_GT(moved, 3000);
}

TEST(UnwindTowards, LeavesSlidesAndLockedJoints) {
  FoldedChain chain;
  chain.n = 2;
  for (FoldedJoint& joint : chain.joints) joint.lower = -20, joint.upper = 20;
  chain.joints[0].slide = true;
  JointVector q{1, 1};
  UnwindTowards(chain, JointVector{9, 9}, {false, true}, &q);
  EXPECT_EQ(q[0], 1);
  EXPECT_EQ(q[1], 1);
}

}  // namespace
}  // namespace robocell::internal
