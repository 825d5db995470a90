#include "robocell/motion/joint_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace robocell {
namespace {

const std::vector<Interval> kLimits = {{-2, 2}, {-2, 2}};

// A wall at x = 0 with a gap above y = 1.
bool NotInTheWall(const JointVector& q) { return std::abs(q[0]) > 0.1 || q[1] > 1; }

bool FinelyFree(const JointPath& path, const FreeFunction& is_free) {
  for (size_t i = 1; i < path.size(); ++i) {
    for (int k = 0; k <= 200; ++k) {
      if (!is_free(Blend(path[i - 1], path[i], k / 200.0))) return false;
    }
  }
  return true;
}

TEST(EdgeIsFree, ChecksEveryStepOnceIncludingTheEndOnly) {
  std::vector<double> seen;
  const FreeFunction record = [&](const JointVector& q) { return seen.push_back(q[0]), true; };
  for (const int steps : {1, 2, 3, 5, 8, 13}) {
    seen.clear();
    EXPECT_TRUE(EdgeIsFree({0, 0}, {steps * 0.1 - 0.01, 0}, record, 0.1));
    std::sort(seen.begin(), seen.end());
    ASSERT_EQ(seen.size(), static_cast<size_t>(steps));
    for (int k = 0; k < steps; ++k)
      EXPECT_NEAR(seen[k], (k + 1) * (steps * 0.1 - 0.01) / steps, 1e-12);
  }
}

TEST(EdgeIsFree, IsFalseIfAnyStepIsBlocked) {
  EXPECT_FALSE(EdgeIsFree({-1, 0}, {1, 0}, NotInTheWall));
  EXPECT_TRUE(EdgeIsFree({-1, 1.5}, {1, 1.5}, NotInTheWall));
  EXPECT_FALSE(EdgeIsFree({-1, 0}, {0, 0}, NotInTheWall));
}

TEST(ConnectTrees, FindsAPathAroundAWall) {
  for (int seed = 0; seed < 20; ++seed) {
    Rng rng = Rng::Stream(seed, "wall");
    const auto path = ConnectTrees({-1, 0}, {1, -0.5}, kLimits, NotInTheWall, rng, {.beyond = 2});
    ASSERT_TRUE(path) << seed;
    EXPECT_EQ(path->front(), (JointVector{-1, 0}));
    EXPECT_EQ(path->back(), (JointVector{1, -0.5}));
    EXPECT_TRUE(FinelyFree(
        *path, [](const JointVector& q) { return std::abs(q[0]) > 0.07 || q[1] > 0.97; }));
    for (const JointVector& q : *path) {
      for (int i = 0; i < 2; ++i) {
        EXPECT_GE(q[i], kLimits[i].lower);
        EXPECT_LE(q[i], kLimits[i].upper);
      }
    }
  }
}

TEST(ConnectTrees, GivesUpWithoutAPath) {
  Rng rng = Rng::Stream(1, "no way");
  int calls = 0;
  const FreeFunction wall = [&](const JointVector& q) { return ++calls, std::abs(q[0]) > 0.1; };
  EXPECT_FALSE(ConnectTrees({-1, 0}, {1, 0}, kLimits, wall, rng));
  EXPECT_LT(calls, 20000);
}

TEST(ConnectTrees, SameStreamSamePath) {
  for (int seed = 0; seed < 5; ++seed) {
    Rng a = Rng::Stream(seed, "same"), b = Rng::Stream(seed, "same");
    EXPECT_EQ(*ConnectTrees({-1, 0}, {1, 0}, kLimits, NotInTheWall, a, {.beyond = 2}),
              *ConnectTrees({-1, 0}, {1, 0}, kLimits, NotInTheWall, b, {.beyond = 2}));
  }
}

TEST(ConnectTrees, UnlimitedJointsAreSearchedNearTheEnds) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Rng rng = Rng::Stream(1, "unlimited");
  const std::vector<Interval> unlimited(2, {-kInfinity, kInfinity});
  const auto path = ConnectTrees({-1, 0}, {1, 0}, unlimited, NotInTheWall, rng, {.beyond = 2});
  ASSERT_TRUE(path);
  for (const JointVector& q : *path) EXPECT_LE(std::abs(q[1]), 2);
}

}  // namespace
}  // namespace robocell
