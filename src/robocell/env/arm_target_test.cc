#include "robocell/env/arm_target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/base/units.h"
#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

TEST(ArmTarget, MovesAlongAndTurnsAroundTheAxesOfTheFrame) {
  Rng rng = Rng::Stream(1, "arm target");
  for (int i = 0; i < 100; ++i) {
    const Pose tcp = RandomPose(rng), delta = RandomPose(rng);
    const Pose moved = MovedBy(tcp, delta);
    EXPECT_TRUE(moved.translation().isApprox(tcp.translation() + delta.translation(), 1e-12));
    EXPECT_TRUE(moved.rotation().isApprox(delta.rotation() * tcp.rotation(), 1e-12));
  }
}

TEST(ArmTarget, ReachesANearTarget) {
  Rng rng = Rng::Stream(2, "arm target");
  for (int i = 0; i < 100; ++i) {
    const Pose from = RandomPose(rng), to = RandomPose(rng);
    EXPECT_EQ(LimitedStep(from, to, {10, 4}), to);
    EXPECT_EQ(LimitedStep(from, to, {INFINITY, INFINITY}), to);
  }
}

TEST(ArmTarget, ApproachesAFarTargetByTheLimit) {
  Rng rng = Rng::Stream(3, "arm target");
  constexpr StepLimit kLimit{0.05, 0.2};
  for (int i = 0; i < 100; ++i) {
    const Pose from = RandomPose(rng), to = RandomPose(rng);
    const Pose sent = LimitedStep(from, to, kLimit);
    const Eigen::Vector3d moved = sent.translation() - from.translation(),
                          wanted = to.translation() - from.translation();
    EXPECT_LE(moved.norm(), kLimit.translation + 1e-12);
    EXPECT_NEAR(moved.cross(wanted).norm(), 0, 1e-12);
    const double turned = AngleBetween(from.quaternion(), sent.quaternion());
    EXPECT_LE(turned, kLimit.rotation + 1e-9);
    EXPECT_NEAR(turned + AngleBetween(sent.quaternion(), to.quaternion()),
                AngleBetween(from.quaternion(), to.quaternion()), 1e-9);
  }
}

TEST(ArmTarget, StepsAddUpToTheWholeMotion) {
  const Pose to = Pose::FromRpy({0.3, -0.2, 0.1}, {0.4, 0.5, -1});
  Pose at;
  for (int i = 0; i < 20; ++i) at = LimitedStep(at, to, {0.05, 0.1});
  EXPECT_TRUE(at.is_close(to, 1e-9, 1e-9));
}

TEST(ArmTarget, LimitsEachJointSeparately) {
  const std::vector<double> from = {0, 1, 2};
  std::vector<double> to = {1, 1.05, -3};
  LimitJointStep(from, 0.1, to);
  EXPECT_EQ(to, (std::vector<double>{0.1, 1.05, 1.9}));
}

TEST(ArmTarget, ObservationsStayInTheirRanges) {
  Rng rng = Rng::Stream(1, "observed quaternions");
  int longer = 0;
  for (int i = 0; i < 3000; ++i) {
    // A turn by half a turn about one axis, as a product of other rotations.
    const Pose first = RandomPose(rng);
    const Pose turn = first.inverse() * (first * Pose::FromRpy({0, 0, 0}, {internal::kPi, 0, 0}));
    std::array<double, 7> seen{};
    ObserveTquat(turn, seen);
    longer += std::abs(turn.quaternion()[0]) > 1 ? 1 : 0;
    for (int k = 3; k < 7; ++k) EXPECT_LE(std::abs(seen[k]), 1);
  }
  EXPECT_GT(longer, 0);
  EXPECT_EQ(ObservedTurn(6.7, 6.8), 6.7);
  EXPECT_NEAR(ObservedTurn(6.9, 6.8), 6.9 - 2 * internal::kPi, 1e-14);
  EXPECT_NEAR(ObservedTurn(-101, 6.8), -101 + 32 * internal::kPi, 1e-13);
}

TEST(ArmTarget, ReadsBothKindsOfCartesianActions) {
  const Pose pose = Pose::FromRpy({0.1, 0.2, 0.3}, {0.4, -0.5, 0.6});
  const auto xyzrpy = pose.xyzrpy();
  EXPECT_TRUE(PoseOfAction(ControlMode::kCartesianTrpy, xyzrpy).is_close(pose, 1e-12, 1e-12));
  std::vector<double> tquat = {0.1, 0.2, 0.3};
  for (const double number : pose.quaternion()) tquat.push_back(-7 * number);
  EXPECT_TRUE(PoseOfAction(ControlMode::kCartesianTquat, tquat).is_close(pose, 1e-12, 1e-12));
  EXPECT_FALSE(HasDirection(std::vector<double>{0, 0, 0, 0}));
  EXPECT_TRUE(HasDirection(std::vector<double>{0, 0, 0.01, 0}));
  constexpr double kMost = std::numeric_limits<double>::max();
  EXPECT_TRUE(HasDirection(std::vector<double>{kMost, -kMost, kMost, kMost}));
  EXPECT_TRUE(HasDirection(std::vector<double>(4, 0.9e-6))) << "together they are long enough";
}

TEST(ArmTarget, QuaternionsOfAnyLengthAreTheSameRotation) {
  const Pose pose = Pose::FromRpy({0, 0, 0}, {0.4, -0.5, 0.6});
  for (const double length : {1e-5, 1.0, 1e160, 1e300, std::numeric_limits<double>::max()}) {
    std::vector<double> tquat = {0, 0, 0};
    for (const double number : pose.quaternion()) tquat.push_back(length * number);
    EXPECT_TRUE(HasDirection(std::span(tquat).subspan(3))) << length;
    EXPECT_TRUE(PoseOfAction(ControlMode::kCartesianTquat, tquat).is_close(pose, 1e-12, 1e-12))
        << length;
  }
  const double most = std::numeric_limits<double>::max();  // its length overflows a double
  EXPECT_TRUE(
      PoseOfAction(ControlMode::kCartesianTquat, std::vector<double>{0, 0, 0, most, 0, 0, most})
          .is_close(Pose::FromRpy({0, 0, 0}, {internal::kPi / 2, 0, 0}), 1e-12, 0));
}

TEST(ArmTarget, ApproachesExtremelyFarTargetsByTheLimit) {
  const Pose sent = LimitedStep(Pose(), Pose(Eigen::Vector3d(3e300, 0, 4e300)), {0.05, 0.1});
  EXPECT_TRUE(sent.translation().isApprox(Eigen::Vector3d(0.03, 0, 0.04), 1e-12));
}

}  // namespace
}  // namespace robocell::internal
