#include "robocell/motion/goal_trees.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace robocell::internal {
namespace {

const JointSpace kSquare = {.bounds = {{-2, 2}, {-2, 2}}, .units = {1, 1}, .range = 0.5};

// A wall at x = 0 with a gap above y = 1.
class Wall : public EdgeJudge {
 public:
  explicit Wall(double gap = 1) : gap_(gap) {}
  bool IsFree(std::span<const double> a, std::span<const double> b) override {
    return IsFree(a, b, 0.1);
  }
  bool IsFree(std::span<const double> a, std::span<const double> b, double half) const {
    for (int k = 1; k <= 100; ++k) {
      const double x = a[0] + k * (b[0] - a[0]) / 100, y = a[1] + k * (b[1] - a[1]) / 100;
      if (std::abs(x) < half && y < gap_ + half - 0.1) return false;
    }
    return true;
  }

 private:
  double gap_;
};

Rows FindPath(const Rows& goals, EdgeJudge* judge, int seed, int* goal = nullptr) {
  GoalTrees trees(std::vector<double>{-1, 0}, goals, kSquare, judge);
  Rng rng = Rng::Stream(seed, "trees");
  for (int k = 0; k < 2000 && !trees.found(); ++k) trees.Step(rng);
  if (goal) *goal = trees.goal();
  return trees.path();
}

TEST(GoalTrees, FindAPathAroundAWall) {
  Wall wall;
  for (int seed = 0; seed < 20; ++seed) {
    Rows path = FindPath({{1, -0.5}}, &wall, seed);
    ASSERT_FALSE(path.empty()) << seed;
    EXPECT_EQ(path.front(), (std::vector<double>{-1, 0}));
    EXPECT_EQ(path.back(), (std::vector<double>{1, -0.5}));
    for (size_t k = 1; k < path.size(); ++k) EXPECT_TRUE(wall.IsFree(path[k - 1], path[k], 0.06));
    const double before = LengthIn(kSquare, path);
    Rng rng = Rng::Stream(seed, "shorten");
    Shorten(&path, kSquare, &wall, rng, 100);
    EXPECT_LE(LengthIn(kSquare, path), before + 1e-9);
    EXPECT_LT(LengthIn(kSquare, path), 3.6);  // 3.22 at best
    EXPECT_EQ(path.front(), (std::vector<double>{-1, 0}));
    EXPECT_EQ(path.back(), (std::vector<double>{1, -0.5}));
    for (size_t k = 1; k < path.size(); ++k) EXPECT_TRUE(wall.IsFree(path[k - 1], path[k], 0.06));
  }
}

TEST(GoalTrees, EndAtOneOfTheGoals) {
  Wall wall;
  const Rows goals = {{1, -1.5}, {-1, 1.5}, {1, 1.5}};
  for (int seed = 0; seed < 10; ++seed) {
    int goal = -1;
    const Rows path = FindPath(goals, &wall, seed, &goal);
    ASSERT_GE(goal, 0);
    EXPECT_EQ(path.back(), goals[goal]);
  }
}

TEST(GoalTrees, TryStraightMotionsToTheNearestGoalsFirst) {
  Wall wall;
  const Rows goals = {{1, -1.5}, {-1, 1.5}, {-1, 0.5}};
  GoalTrees trees(std::vector<double>{-1, 0}, goals, kSquare, &wall);
  trees.TryDirect(2);
  EXPECT_EQ(trees.goal(), 2);
  EXPECT_EQ(trees.path().size(), 2u);
}

TEST(GoalTrees, SameStreamSamePath) {
  Wall wall;
  for (int seed = 0; seed < 5; ++seed)
    EXPECT_EQ(FindPath({{1, -0.5}}, &wall, seed), FindPath({{1, -0.5}}, &wall, seed));
}

TEST(GoalTrees, KnowWhichTreeIsShutIn) {
  class OnlyNearTheGoal : public EdgeJudge {
   public:
    bool IsFree(std::span<const double> a, std::span<const double> b) override {
      return a[0] > 0 && b[0] > 0;
    }
  } judge;
  GoalTrees trees(std::vector<double>{-1, 0}, {{1, 0}}, kSquare, &judge);
  Rng rng = Rng::Stream(1, "trees");
  for (int k = 0; k < 200; ++k) trees.Step(rng);
  EXPECT_FALSE(trees.found());
  EXPECT_FALSE(trees.start_grows());
}

TEST(GoalTrees, KeepToWhatProjectionsAllow) {
  // Only configurations on a circle of radius 1 are allowed.
  class Circle : public EdgeJudge {
   public:
    bool IsFree(std::span<const double>, std::span<const double> b) override {
      return std::abs(std::hypot(b[0], b[1]) - 1) < 1e-9;
    }
    bool Project(std::span<double> q) override {
      const double radius = std::hypot(q[0], q[1]);
      if (radius < 1e-3) return false;
      q[0] /= radius, q[1] /= radius;
      return true;
    }
  } circle;
  GoalTrees trees(std::vector<double>{-1, 0}, {{1, 0}}, kSquare, &circle);
  Rng rng = Rng::Stream(1, "circle");
  for (int k = 0; k < 2000 && !trees.found(); ++k) trees.Step(rng);
  ASSERT_TRUE(trees.found());
  for (const std::vector<double>& q : trees.path()) EXPECT_NEAR(std::hypot(q[0], q[1]), 1, 1e-9);
}

}  // namespace
}  // namespace robocell::internal
