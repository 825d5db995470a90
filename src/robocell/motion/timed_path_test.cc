#include "robocell/motion/timed_path.h"

#include <gtest/gtest.h>

namespace robocell {
namespace {

TEST(TimedPath, ReachesItsEndExactlyInTheTicksItSaid) {
  TimedPath path({0, 1}, 0.066);
  path.AddLeg({{1, 0}}, 1.2, 0.15);
  const int ticks = path.remaining();
  EXPECT_EQ(ticks, 24);  // 1.875 / 1.2 s
  for (int i = 0; i < ticks; ++i) {
    EXPECT_FALSE(path.finished());
    EXPECT_EQ(path.remaining(), ticks - i);
    path.Next();
  }
  EXPECT_TRUE(path.finished());
  EXPECT_EQ(path.Next(), (JointVector{1, 0}));
}

TEST(TimedPath, NoTargetIsFasterThanAsked) {
  TimedPath path({0}, 0.02);
  path.AddLeg({{2}}, 0.8, 0.15);
  double before = 0, fastest = 0;
  while (!path.finished()) {
    const double now = path.Next()[0];
    EXPECT_GE(now, before);
    fastest = std::max(fastest, (now - before) / 0.02);
    before = now;
  }
  EXPECT_LE(fastest, 0.8 + 1e-9);
  EXPECT_GT(fastest, 0.75);
}

TEST(TimedPath, StartsAndEndsEachLegGently) {
  TimedPath path({0}, 0.01);
  path.AddLeg({{1}}, 1, 0.5);
  path.AddLeg({{0}}, 1, 0.5);
  const double first = path.Next()[0];
  EXPECT_LT(first, 1e-4);
  double nearest_end = 0;
  while (path.remaining() > 188) nearest_end = path.Next()[0];
  EXPECT_EQ(nearest_end, 1);
  EXPECT_GT(path.Next()[0], 1 - 1e-4);
}

TEST(TimedPath, ShortMotionsTakeTheLeastTime) {
  TimedPath path({0}, 0.066);
  path.AddLeg({{0.001}}, 1, 0.5);
  EXPECT_EQ(path.remaining(), 8);
}

TEST(TimedPath, StaysOnTheLinesBetweenItsPoints) {
  TimedPath path({0, 0}, 0.01);
  path.AddLeg({{1, 0}, {1, 1}}, 1, 0.5);
  bool passed = false;
  while (!path.finished()) {
    const JointVector q = path.Next();
    EXPECT_TRUE(q[1] == 0 || q[0] == 1) << q[0] << " " << q[1];
    passed |= q[0] > 0.9 && q[1] < 0.1;
  }
  EXPECT_TRUE(passed);
}

}  // namespace
}  // namespace robocell
