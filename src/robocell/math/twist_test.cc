#include "robocell/math/twist.h"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr int kTwists = 2000;

Twist RandomTwist(Rng& rng) {
  const Vector3d linear = RandomVector(rng);
  return {linear, RandomVector(rng)};
}

Wrench RandomWrench(Rng& rng) {
  const Vector3d force = RandomVector(rng);
  return {force, RandomVector(rng)};
}

double Distance(const Twist& a, const Twist& b) { return (a - b).vector().norm(); }
double Distance(const Wrench& a, const Wrench& b) { return (a - b).vector().norm(); }

// A body that moves in B: its pose at time t.
Pose Moving(const Pose& start, const Vector3d& velocity, const Vector3d& spin, double t) {
  return Pose(start.translation() + t * velocity + t * t * spin,
              QuaternionProduct(QuaternionFromRotvec(t * spin), start.quaternion()));
}

// The twist in A of a body with pose X_AM(t), from the matrix dX/dt * X^-1 by central differences.
template <typename Motion>
Twist FiniteDifference(const Motion& X_AM) {
  constexpr double h = 1e-5;
  const Matrix4d rate = (X_AM(h).matrix() - X_AM(-h).matrix()) / (2 * h);
  const Matrix4d twist = rate * X_AM(0).matrix().inverse();
  return {twist.topRightCorner<3, 1>(), {twist(2, 1), twist(0, 2), twist(1, 0)}};
}

TEST(Twist, TransformedMatchesAnObserverInTheOtherFrame) {
  Rng rng = Rng::Stream(1, "adjoint");
  for (int i = 0; i < kTwists; ++i) {
    const Pose X_AB = RandomPose(rng), start = RandomPose(rng);
    const Vector3d velocity = RandomVector(rng), spin = RandomVector(rng);
    const auto in_B = [&](double t) { return Moving(start, velocity, spin, t); };
    const auto in_A = [&](double t) { return X_AB * in_B(t); };
    ASSERT_LT(Distance(Transformed(X_AB, FiniteDifference(in_B)), FiniteDifference(in_A)), 1e-8);
  }
}

TEST(Twist, ShiftedIsTheVelocityOfAnotherPointOfTheBody) {
  Rng rng = Rng::Stream(1, "shift");
  constexpr double h = 1e-6;
  for (int i = 0; i < kTwists; ++i) {
    const Twist twist = RandomTwist(rng);
    const Vector3d p = RandomVector(rng);
    const auto point = [&](double t) {
      return Vector3d(t * twist.linear + Rotate(QuaternionFromRotvec(t * twist.angular), p));
    };
    const Twist shifted = Shifted(twist, p);
    ASSERT_LT((shifted.linear - (point(h) - point(-h)) / (2 * h)).norm(), 1e-8);
    ASSERT_EQ(shifted.angular, twist.angular);
    ASSERT_LT(Distance(Shifted(shifted, -p), twist), 1e-14);
  }
}

TEST(Wrench, ShiftedHasTheTorqueOfTheSameForceAboutAnotherPoint) {
  // 2 N downwards, 0.5 m in front of the reference point, pulls the front down: a positive torque
  // about y.
  const Wrench at_tip = {.force = {0, 0, -2}};
  const Wrench at_base = Shifted(at_tip, {-0.5, 0, 0});
  EXPECT_EQ(at_base.force, at_tip.force);
  EXPECT_LT((at_base.torque - Vector3d(0, 1, 0)).norm(), 1e-15);
}

TEST(Wrench, PowerIsTheSameInEveryFrame) {
  Rng rng = Rng::Stream(1, "power");
  for (int i = 0; i < kTwists; ++i) {
    const Pose X_AB = RandomPose(rng);
    const Twist twist = RandomTwist(rng);
    const Wrench wrench = RandomWrench(rng);
    const double power = Power(twist, wrench);
    ASSERT_NEAR(Power(Transformed(X_AB, twist), Transformed(X_AB, wrench)), power, 2e-14);
    ASSERT_NEAR(Power(Rotated(X_AB.quaternion(), twist), Rotated(X_AB.quaternion(), wrench)), power,
                1e-14);
    ASSERT_NEAR(Power(Shifted(twist, X_AB.translation()), Shifted(wrench, X_AB.translation())),
                power, 2e-14);
  }
}

TEST(Twist, TransformationsComposeLikePoses) {
  Rng rng = Rng::Stream(1, "compose");
  for (int i = 0; i < kTwists; ++i) {
    const Pose X_AB = RandomPose(rng), X_BC = RandomPose(rng);
    const Twist twist = RandomTwist(rng);
    const Wrench wrench = RandomWrench(rng);
    ASSERT_LT(
        Distance(Transformed(X_AB, Transformed(X_BC, twist)), Transformed(X_AB * X_BC, twist)),
        2e-14);
    ASSERT_LT(
        Distance(Transformed(X_AB, Transformed(X_BC, wrench)), Transformed(X_AB * X_BC, wrench)),
        2e-14);
    ASSERT_LT(Distance(Transformed(X_AB.inverse(), Transformed(X_AB, twist)), twist), 1e-14);
  }
}

TEST(Twist, TheAdjointMatrixIsTheTransformation) {
  Rng rng = Rng::Stream(1, "matrix");
  for (int i = 0; i < kTwists; ++i) {
    const Pose X_AB = RandomPose(rng);
    const Twist twist = RandomTwist(rng);
    const Wrench wrench = RandomWrench(rng);
    ASSERT_LT((AdjointMatrix(X_AB) * twist.vector() - Transformed(X_AB, twist).vector()).norm(),
              1e-14);
    ASSERT_LT((AdjointMatrix(X_AB.inverse()).transpose() * wrench.vector() -
               Transformed(X_AB, wrench).vector())
                  .norm(),
              1e-14);
  }
}

TEST(Twist, SixNumbersAreLinearThenAngular) {
  const Twist twist = {.linear = {1, 2, 3}, .angular = {4, 5, 6}};
  EXPECT_EQ(twist.vector()[0], 1);
  EXPECT_EQ(twist.vector()[5], 6);
  EXPECT_EQ(Twist::FromVector(twist.vector()), twist);
  EXPECT_EQ((2 * twist + twist - twist).angular, Vector3d(8, 10, 12));
}

TEST(Wrench, SixNumbersAreForceThenTorque) {
  const Wrench wrench = {.force = {1, 2, 3}, .torque = {4, 5, 6}};
  EXPECT_EQ(wrench.vector()[2], 3);
  EXPECT_EQ(wrench.vector()[3], 4);
  EXPECT_EQ(Wrench::FromVector(wrench.vector()), wrench);
  EXPECT_EQ((2 * wrench + wrench - wrench).force, Vector3d(2, 4, 6));
}

}  // namespace
}  // namespace robocell
