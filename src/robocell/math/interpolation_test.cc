#include "robocell/math/interpolation.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Peaks {
  double velocity = 0;
  double acceleration = 0;
};

// The largest velocity and acceleration of a motion.
template <typename Motion>
Peaks PeaksOf(const Motion& motion, double duration) {
  Peaks peaks;
  for (int i = 0; i <= 2000; ++i) {
    const CoordinateState state = motion(duration * i / 2000);
    peaks.velocity = std::max(peaks.velocity, std::abs(state.velocity));
    peaks.acceleration = std::max(peaks.acceleration, std::abs(state.acceleration));
  }
  return peaks;
}

// Checks velocity and acceleration against differences of the position, away from the corners of
// the acceleration.
template <typename Motion>
void ExpectDerivativesFit(const Motion& motion, double duration, double jerk_bound) {
  const double h = 1e-4 * duration;
  for (int i = 1; i < 50; ++i) {
    const double t = duration * i / 50.3;
    const double before = motion(t - h).position, now = motion(t).position,
                 after = motion(t + h).position;
    EXPECT_NEAR(motion(t).velocity, (after - before) / (2 * h), jerk_bound * h * h) << t;
    EXPECT_NEAR(motion(t).acceleration, (after - 2 * now + before) / (h * h), jerk_bound * h) << t;
  }
}

TEST(MinimumJerk, StartsAndEndsAtRest) {
  for (const double time : {-1.0, 0.0}) {
    const CoordinateState state = MinimumJerk(time, 2);
    EXPECT_EQ(state.position, 0);
    EXPECT_EQ(state.velocity, 0);
    EXPECT_EQ(state.acceleration, 0);
  }
  for (const double time : {2.0, 9.0}) {
    const CoordinateState state = MinimumJerk(time, 2);
    EXPECT_EQ(state.position, 1);
    EXPECT_EQ(state.velocity, 0);
    EXPECT_EQ(state.acceleration, 0);
  }
  EXPECT_NEAR(MinimumJerk(1e-6, 2).acceleration, 0, 1e-4);
  EXPECT_NEAR(MinimumJerk(2 - 1e-6, 2).acceleration, 0, 1e-4);
  EXPECT_EQ(MinimumJerk(1, 2).position, 0.5);
}

TEST(MinimumJerk, VelocityAndAccelerationAreTheDerivatives) {
  ExpectDerivativesFit([](double t) { return MinimumJerk(t, 2); }, 2, 60);
}

TEST(MinimumJerk, WithoutDurationItJumps) {
  EXPECT_EQ(MinimumJerk(0, 0).position, 1);
  EXPECT_EQ(MinimumJerk(1, 0).position, 1);
  ExpectThrow<ArgumentError>([] { MinimumJerk(0, -1); },
                             "the duration of a motion must be >= 0 s, not -1");
}

TEST(MinimumJerk, TheDurationIsTheShortestWithinTheLimits) {
  Rng rng = Rng::Stream(1, "duration");
  for (int i = 0; i < 200; ++i) {
    const double distance = rng.Uniform(-3, 3), v = rng.Uniform(0.1, 3), a = rng.Uniform(0.1, 9);
    const double duration = MinimumJerkDuration(distance, v, a);
    const Peaks peaks = PeaksOf([&](double t) { return MinimumJerk(t, duration); }, duration);
    const double tightest = std::max(peaks.velocity * std::abs(distance) / v,
                                     peaks.acceleration * std::abs(distance) / a);
    ASSERT_LE(tightest, 1 + 1e-12);
    ASSERT_GT(tightest, 1 - 1e-5);
  }
}

TEST(MinimumJerk, IgnoresInfiniteLimits) {
  EXPECT_DOUBLE_EQ(MinimumJerkDuration(1, 1, kInfinity), 1.875);
  EXPECT_EQ(MinimumJerkDuration(1, kInfinity, kInfinity), 0);
  ExpectThrow<ArgumentError>([] { MinimumJerkDuration(1, 0, 1); },
                             "max_velocity must be > 0, not 0");
  ExpectThrow<ArgumentError>([] { MinimumJerkDuration(1, 1, NAN); },
                             "max_acceleration must be > 0, not nan");
  ExpectThrow<ArgumentError>([] { MinimumJerkDuration(NAN, 1, 1); },
                             "the distance of a motion must be finite, not nan");
}

TEST(TrapezoidalMotion, KeepsItsLimitsReachesItsEndAndIsContinuous) {
  Rng rng = Rng::Stream(1, "trapezoid");
  for (int i = 0; i < 300; ++i) {
    const double distance = rng.Uniform(-3, 3), v = rng.Uniform(0.1, 3), a = rng.Uniform(0.1, 9);
    const TrapezoidalMotion motion(distance, v, a);
    const double duration = motion.duration(), h = duration / 2000;
    for (int k = 0; k < 2000; ++k) {
      const CoordinateState now = motion.at(k * h), next = motion.at((k + 1) * h);
      ASSERT_LE(std::abs(now.velocity), v * (1 + 1e-12));
      ASSERT_LE(std::abs(now.acceleration), a);
      ASSERT_LE(std::abs(next.velocity - now.velocity), a * h * (1 + 1e-9));
      // The trapezoid rule is exact except at the corners.
      ASSERT_NEAR(next.position - now.position, (now.velocity + next.velocity) / 2 * h, a * h * h);
    }
    ASSERT_EQ(motion.at(duration).position, distance);
    ASSERT_NEAR(motion.at(duration * (1 - 1e-9)).position, distance, 1e-8);
    ASSERT_EQ(motion.at(duration).velocity, 0);
  }
}

TEST(TrapezoidalMotion, IsAsFastAsTheLimitsAllow) {
  EXPECT_DOUBLE_EQ(TrapezoidalMotion(3, 1, 1).duration(), 4);      // 1 s up, 2 s at speed, 1 s down
  EXPECT_DOUBLE_EQ(TrapezoidalMotion(-0.25, 1, 1).duration(), 1);  // a triangle up to 0.5
  EXPECT_DOUBLE_EQ(TrapezoidalMotion(-0.25, 1, 1).at(0.5).velocity, -0.5);
  EXPECT_EQ(TrapezoidalMotion(3, 1, 1).at(2).acceleration, 0);
  EXPECT_EQ(TrapezoidalMotion(3, 1, 1).at(3.5).acceleration, -1);
}

TEST(TrapezoidalMotion, WithoutDistanceHasNoDuration) {
  const TrapezoidalMotion motion(0, 1, 1);
  EXPECT_EQ(motion.duration(), 0);
  EXPECT_EQ(motion.at(0).position, 0);
  EXPECT_EQ(motion.at(1).position, 0);
}

TEST(TrapezoidalMotion, RejectsInvalidLimits) {
  ExpectThrow<ArgumentError>([] { TrapezoidalMotion(1, -1, 1); },
                             "max_velocity must be > 0, not -1");
  ExpectThrow<ArgumentError>([] { TrapezoidalMotion(1, 1, kInfinity); },
                             "distance 1, max_velocity 1 and max_acceleration inf must be finite");
  ExpectThrow<ArgumentError>([] { TrapezoidalMotion(NAN, 1, 1); }, "distance nan");
}

TEST(InterpolateJoints, IsExactAtBothEnds) {
  Rng rng = Rng::Stream(1, "joints");
  for (int i = 0; i < 1000; ++i) {
    const std::array from = {rng.Uniform(-3, 3), rng.Uniform(-3, 3)};
    const std::array to = {rng.Uniform(-3, 3), rng.Uniform(-3, 3)};
    std::array<double, 2> out;
    InterpolateJoints(from, to, 0, out);
    ASSERT_EQ(out, from);
    InterpolateJoints(from, to, 1, out);
    ASSERT_EQ(out, to);
    const double s = rng.Uniform();
    InterpolateJoints(from, to, s, out);
    for (int k = 0; k < 2; ++k) {
      ASSERT_NEAR(out[k], from[k] + s * (to[k] - from[k]), 1e-14);
      ASSERT_GE(out[k], std::min(from[k], to[k]) - 1e-15);
      ASSERT_LE(out[k], std::max(from[k], to[k]) + 1e-15);
    }
    std::array<double, 2> in_place = from;
    InterpolateJoints(in_place, to, s, in_place);
    ASSERT_EQ(in_place, out);
  }
}

TEST(InterpolateJoints, RejectsDifferentSizes) {
  const std::vector<double> two(2), three(3);
  std::vector<double> out(2);
  ExpectThrow<ArgumentError>([&] { InterpolateJoints(two, three, 0, out); },
                             "the goal has 3 numbers, but the start has 2");
  ExpectThrow<ArgumentError>([&] { InterpolateJoints(three, three, 0, out); },
                             "out has 2 numbers, but the start has 3");
  ExpectThrow<ArgumentError>([&] { JointMoveDuration(two, two, three, two); },
                             "max_velocity has 3 numbers, but the start has 2");
  ExpectThrow<ArgumentError>([&] { JointMoveDuration(two, two, two, three); },
                             "max_acceleration has 3 numbers, but the start has 2");
}

TEST(JointMoveDuration, IsThatOfTheSlowestJoint) {
  const std::array<double, 2> from = {0, 1}, to = {1, -1}, velocity = {1, 0.5},
                              acceleration = {9, 9};
  EXPECT_EQ(JointMoveDuration(from, to, velocity, acceleration), MinimumJerkDuration(2, 0.5, 9));
  EXPECT_EQ(JointMoveDuration(from, from, velocity, acceleration), 0);
}

TEST(PoseMoveDuration, KeepsTheLimitsOfTranslationAndRotation) {
  Rng rng = Rng::Stream(1, "pose move");
  const PoseMoveLimits limits = {.linear_velocity = 0.5,
                                 .linear_acceleration = 2,
                                 .angular_velocity = 1,
                                 .angular_acceleration = 4};
  for (int i = 0; i < 50; ++i) {
    const Pose from = RandomPose(rng), to = RandomPose(rng);
    const double duration = PoseMoveDuration(from, to, limits), h = duration / 500;
    double linear = 0, angular = 0;
    for (int k = 0; k < 500; ++k) {
      const Pose a = from.interpolate(to, MinimumJerk(k * h, duration).position);
      const Pose b = from.interpolate(to, MinimumJerk((k + 1) * h, duration).position);
      linear = std::max(linear, (b.translation() - a.translation()).norm() / h);
      angular = std::max(angular, AngleBetween(a.quaternion(), b.quaternion()) / h);
    }
    ASSERT_LE(linear, 0.5 + 1e-9);
    ASSERT_LE(angular, 1 + 1e-9);
    ASSERT_GT(std::max(linear / 0.5, angular),
              0.99);  // velocity is the tighter limit over these distances
  }
}

}  // namespace
}  // namespace robocell
