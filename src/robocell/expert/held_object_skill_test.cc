#include "robocell/expert/held_object_skill.h"

#include <gtest/gtest.h>

namespace robocell::internal {
namespace {

TEST(PathWalk, ReachesTheEndAtItsSpeed) {
  HeldPath path = {Pose()};
  AppendStraight(path, Pose(Eigen::Vector3d(0.1, 0, 0)));
  PathWalk walk(path, 0.05, 1);
  for (int i = 0; i < 10; ++i) walk.Move(0.1);
  EXPECT_NEAR(walk.place().translation().x(), 0.05, 1e-9);
  for (int i = 0; i < 11; ++i) walk.Move(0.1);
  EXPECT_TRUE(walk.at_end());
  EXPECT_NEAR(walk.place().translation().x(), 0.1, 1e-12);
  walk.Restart();
  EXPECT_NEAR(walk.place().translation().x(), 0, 1e-12);
}

}  // namespace
}  // namespace robocell::internal
