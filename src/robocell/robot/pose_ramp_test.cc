#include "robocell/robot/pose_ramp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

constexpr PoseRamp::Limits kLimits{0.5, 2, 5, 20};
constexpr double kTick = 0.002;
constexpr double kRounding = 1e-9;

// Computes the pose after `ticks`, each of which keeps the limits and agrees with its velocities.
void Follow(PoseRamp& ramp, const Pose& goal, int ticks, double seconds = kTick) {
  for (int i = 0; i < ticks; ++i) {
    const Pose before = ramp.pose();
    const Eigen::Vector3d linear = ramp.linear_velocity(), angular = ramp.angular_velocity();
    ramp.Advance(goal, kLimits, seconds);
    const Eigen::Vector3d moved = ramp.pose().translation() - before.translation();
    const Pose turned = ramp.pose() * before.inverse();
    ASSERT_LE(ramp.linear_velocity().norm(), kLimits.linear_speed + kRounding);
    ASSERT_LE(ramp.angular_velocity().norm(), kLimits.angular_speed + kRounding);
    ASSERT_LE((ramp.linear_velocity() - linear).norm(),
              kLimits.linear_acceleration * seconds + kRounding);
    ASSERT_LE((ramp.angular_velocity() - angular).norm(),
              kLimits.angular_acceleration * seconds + kRounding);
    ASSERT_LT((moved - ramp.linear_velocity() * seconds).norm(), kRounding);
    ASSERT_LT((turned.rotvec() - ramp.angular_velocity() * seconds).norm(), kRounding);
  }
}

TEST(PoseRamp, KeepsItsLimitsAndEndsExactlyAtTheGoal) {
  Rng rng = Rng::Stream(7, "pose ramp");
  for (int trial = 0; trial < 20; ++trial) {
    PoseRamp ramp(RandomPose(rng));
    const Pose goal = RandomPose(rng);
    const Eigen::Vector3d displacement = goal.translation() - ramp.pose().translation();
    const double longest = std::max(displacement.norm() / kLimits.linear_speed,
                                    (ramp.pose().inverse() * goal).angle() / kLimits.angular_speed);
    Follow(ramp, goal, static_cast<int>((longest + 0.5) / kTick));
    EXPECT_EQ(ramp.pose(), goal);
    Follow(ramp, goal, 2);
    EXPECT_EQ(ramp.linear_velocity().norm(), 0);
    EXPECT_EQ(ramp.angular_velocity().norm(), 0);
  }
}

TEST(PoseRamp, TakesTheTimeOfItsSpeedAndRamps) {
  PoseRamp ramp;
  const Pose goal(Eigen::Vector3d(1, 0, 0));
  int ticks = 0;
  while (!(ramp.pose() == goal)) {
    ramp.Advance(goal, kLimits, kTick);
    ASSERT_LT(++ticks, 5000);
  }
  EXPECT_GT(ticks * kTick, 1 / kLimits.linear_speed);
  EXPECT_LT(ticks * kTick, 1 / kLimits.linear_speed + 0.2);
}

TEST(PoseRamp, TurnsToAnotherGoalWithinItsLimits) {
  Rng rng = Rng::Stream(8, "pose ramp");
  PoseRamp ramp;
  Pose goal;
  for (int change = 0; change < 30; ++change) {
    goal = RandomPose(rng);
    Follow(ramp, goal, 60);
  }
  Follow(ramp, goal, 3000);
  EXPECT_EQ(ramp.pose(), goal);
}

TEST(PoseRamp, LongTicksRespectTheLimits) {
  Rng rng = Rng::Stream(9, "pose ramp");
  for (const double seconds : {0.01, 0.02, 0.05}) {
    PoseRamp ramp;
    const Pose goal = RandomPose(rng);
    Follow(ramp, goal, 1000, seconds);
    EXPECT_TRUE(ramp.pose().is_close(goal, 1e-6, 1e-6)) << seconds;
  }
}

TEST(PoseRamp, AZeroTickDoesNotMove) {
  PoseRamp ramp;
  ramp.Advance(Pose(Eigen::Vector3d(1, 0, 0)), kLimits, 0);
  EXPECT_EQ(ramp.pose(), Pose());
}

}  // namespace
}  // namespace robocell::internal
