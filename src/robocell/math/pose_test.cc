#include "robocell/math/pose.h"

#include <cmath>
#include <numbers>
#include <sstream>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr int kPoses = 3000;

double Distance(const Pose& a, const Pose& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

TEST(Pose, DefaultIsTheIdentity) {
  EXPECT_EQ(Pose().matrix(), Matrix4d::Identity());
  EXPECT_EQ(Pose(), Pose(Vector3d::Zero()));
}

TEST(Pose, AcceptsListsAndExpressions) {
  const Pose pose({1, 2, 3}, {0.6, 0, 0, 0.8});
  const Vector3d t = pose.translation();
  EXPECT_EQ(Pose(0.5 * t, pose.quaternion()).translation(), Vector3d(0.5, 1, 1.5));
  EXPECT_EQ(Pose(0.5 * t), Pose({0.5, 1, 1.5}));
  EXPECT_TRUE(Pose(t, pose.rotation() * pose.rotation())
                  .is_close(Pose(t) * Pose({0, 0, 0}, pose.quaternion()) *
                                Pose({0, 0, 0}, pose.quaternion()),
                            1e-12, 0));
  EXPECT_TRUE(Pose(pose.matrix() * pose.matrix()).is_close(pose * pose, 1e-12, 1e-12));
}

TEST(Pose, FormsAGroupLikeItsMatrices) {
  Rng rng = Rng::Stream(1, "group");
  for (int i = 0; i < kPoses; ++i) {
    const Pose a = RandomPose(rng), b = RandomPose(rng), c = RandomPose(rng);
    ASSERT_LT(((a * b).matrix() - a.matrix() * b.matrix()).norm(), 1e-14);
    ASSERT_LT(Distance((a * b) * c, a * (b * c)), 2e-14);
    ASSERT_LT(Distance(a * a.inverse(), Pose()), 1e-14);
    ASSERT_LT(Distance(a.inverse() * a, Pose()), 1e-14);
    ASSERT_LT((a.inverse().matrix() - a.matrix().inverse()).norm(), 2e-14);
    ASSERT_LT(Distance((a * b).inverse(), b.inverse() * a.inverse()), 2e-14);
    ASSERT_EQ(a * Pose(), a);
    ASSERT_EQ(Pose() * a, a);
  }
}

TEST(Pose, MovesPointsLikeItsMatrix) {
  Rng rng = Rng::Stream(1, "points");
  for (int i = 0; i < kPoses; ++i) {
    const Pose pose = RandomPose(rng);
    const Vector3d p = RandomVector(rng);
    ASSERT_LT((pose * p - (pose.matrix() * p.homogeneous()).head<3>()).norm(), 4e-15);
  }
}

TEST(Pose, EveryRepresentationRoundTrips) {
  Rng rng = Rng::Stream(1, "representations");
  for (int i = 0; i < kPoses; ++i) {
    const Pose pose = RandomPose(rng);
    const Vector3d& t = pose.translation();
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = pose.rotation();
    ASSERT_EQ(Pose(t, pose.quaternion()), pose);  // to the last bit
    ASSERT_EQ(Pose::FromWxyz(t.data(), pose.quaternion_wxyz().data()), pose);
    double position[3], wxyz[4];
    pose.ToWxyz(position, wxyz);
    ASSERT_EQ(Pose::FromWxyz(position, wxyz), pose);
    ASSERT_LT(Distance(Pose(t, pose.rotation()), pose), 2e-15);
    ASSERT_LT(Distance(Pose(pose.matrix()), pose), 2e-15);
    ASSERT_LT(Distance(Pose::FromTranslationAndMatrix(t.data(), rows.data()), pose), 2e-15);
    ASSERT_LT(Distance(Pose::FromRpy(t, pose.rpy()), pose), 5e-15);
    ASSERT_LT(Distance(Pose::FromRotvec(t, pose.rotvec()), pose), 3e-15);
    ASSERT_NEAR(pose.angle(), pose.rotvec().norm(), 2e-15);
  }
}

TEST(Pose, XyzrpyIsTranslationThenAngles) {
  const std::array<double, 6> numbers = Pose::FromRpy({1, 2, 3}, {0.1, -0.2, 0.3}).xyzrpy();
  const double expected[6] = {1, 2, 3, 0.1, -0.2, 0.3};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(numbers[i], expected[i], 1e-15);
}

TEST(Pose, FromRpyTurnsAboutFixedAxes) {
  // A quarter roll, then a quarter yaw about the fixed z: the body's y axis points to world z, its
  // x axis to world y.
  const Pose pose = Pose::FromRpy({0, 0, 0}, {std::numbers::pi / 2, 0, std::numbers::pi / 2});
  EXPECT_LT((pose * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((pose * Vector3d::UnitY() - Vector3d::UnitZ()).norm(), 1e-15);
}

TEST(Pose, InterpolateStartsHereAndEndsThere) {
  Rng rng = Rng::Stream(1, "interpolate");
  for (int i = 0; i < kPoses; ++i) {
    const Pose a = RandomPose(rng), b = RandomPose(rng);
    const double s = rng.Uniform();
    const Pose middle = a.interpolate(b, s);
    ASSERT_EQ(a.interpolate(b, 0), a);
    ASSERT_EQ(a.interpolate(b, 1), b);
    ASSERT_LT(Distance(middle, b.interpolate(a, 1 - s)), 1e-13);
    ASSERT_LT((middle.translation() - ((1 - s) * a.translation() + s * b.translation())).norm(),
              2e-15);
    ASSERT_NEAR((a.inverse() * middle).angle(), s * (a.inverse() * b).angle(), 1e-14);
  }
}

TEST(Pose, LimitsBoundOnePartAndKeepItsDirection) {
  Rng rng = Rng::Stream(1, "limits");
  for (int i = 0; i < kPoses; ++i) {
    const Pose pose = RandomPose(rng);
    const double metres = rng.Uniform(0, 3), radians = rng.Uniform(0, 3);
    const Pose near = pose.limit_translation(metres), slow = pose.limit_rotation(radians);
    ASSERT_NEAR(near.translation().norm(), std::min(metres, pose.translation().norm()), 2e-15);
    ASSERT_LT(near.translation().cross(pose.translation()).norm(), 1e-14);
    ASSERT_EQ(near.quaternion(), pose.quaternion());
    ASSERT_NEAR(slow.angle(), std::min(radians, pose.angle()), 2e-15);
    ASSERT_LT(slow.rotvec().cross(pose.rotvec()).norm(), 1e-14);
    ASSERT_GE(slow.rotvec().dot(pose.rotvec()), 0);
    ASSERT_EQ(slow.translation(), pose.translation());
    ASSERT_TRUE(pose.angle() > radians || slow == pose);
  }
}

TEST(Pose, ZeroLimitsGiveTheIdentity) {
  const Pose pose({1, 2, 3}, Quaternion{0.6, 0, 0, 0.8});
  EXPECT_EQ(pose.limit_translation(0).limit_rotation(0), Pose());
  EXPECT_EQ(Pose().limit_translation(0).limit_rotation(0), Pose());
}

TEST(Pose, RejectsNegativeLimits) {
  ExpectThrow<ArgumentError>([] { Pose().limit_translation(-1); },
                             "pose: cannot limit the translation to -1");
  ExpectThrow<ArgumentError>([] { Pose().limit_rotation(NAN); },
                             "pose: cannot limit the rotation to nan");
}

TEST(Pose, IsCloseLooksAtBothParts) {
  const Pose a({1, 0, 0}, Quaternion{0, 0, 0, 1});
  const Pose b = Pose::FromRotvec({1, 0.01, 0}, {0, 0, 0.1});
  EXPECT_TRUE(a.is_close(b, 0.11, 0.011));
  EXPECT_FALSE(a.is_close(b, 0.09, 0.011));
  EXPECT_FALSE(a.is_close(b, 0.11, 0.009));
  EXPECT_TRUE(a.is_close(a, 0, 0));
}

TEST(Pose, EqualityIsExact) {
  const Pose a({1, 2, 3}, Quaternion{0.6, 0, 0, 0.8});
  EXPECT_EQ(a, Pose({1, 2, 3}, Quaternion{-0.6, 0, 0, -0.8}));
  EXPECT_NE(a, Pose({1, 2, std::nextafter(3, 4)}, Quaternion{0.6, 0, 0, 0.8}));
  EXPECT_NE(a, Pose({1, 2, 3}));
}

TEST(Pose, IntegrateUndoesPoseDifference) {
  Rng rng = Rng::Stream(1, "difference");
  for (int i = 0; i < kPoses; ++i) {
    const Pose a = RandomPose(rng), b = RandomPose(rng);
    const Eigen::Matrix<double, 6, 1> difference = PoseDifference(a, b);
    ASSERT_LT(Distance(Integrate(a, difference), b), 1e-14);
    ASSERT_LT((PoseDifference(a, a)).norm(), 1e-14);
    ASSERT_EQ(difference.head<3>(), b.translation() - a.translation());
    // The rotation vector is expressed in the common frame: turning a about it from outside gives
    // b.
    const Vector3d turn = difference.tail<3>();
    const Matrix3d outside = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    ASSERT_LT((outside * a.rotation() - b.rotation()).norm(), 1e-14);
  }
}

TEST(Pose, RejectsInvalidPoses) {
  ExpectThrow<ArgumentError>(
      [] {
        Pose({0, NAN, 0});
      },
      "pose: the translation [0, nan, 0] is not finite");
  ExpectThrow<ArgumentError>([] { Pose({INFINITY, 0, 0}, Quaternion{0, 0, 0, 1}); }, "[inf, 0, 0]");
  ExpectThrow<ArgumentError>([] { Pose({0, 0, 0}, Quaternion{1, 1, 0, 0}); }, "has length 1.41421");
  ExpectThrow<ArgumentError>(
      [] {
        Pose::FromRpy({0, 0, 0}, {0, NAN, 0});
      },
      "pose: the rpy [0, nan, 0] is not finite");
  ExpectThrow<ArgumentError>(
      [] {
        Pose::FromRotvec({0, 0, 0}, {0, 0, NAN});
      },
      "the rotation vector [0, 0, nan] is not finite");
  ExpectThrow<ArgumentError>([] { Pose(Vector3d::Zero(), 2 * Matrix3d::Identity()); },
                             "not orthonormal");
  Matrix4d projective = Matrix4d::Identity();
  projective(3, 0) = 0.5;
  ExpectThrow<ArgumentError>([&] { Pose{projective}; },
                             "pose: the last row of a 4x4 matrix must be [0, 0, 0, 1], not "
                             "[0.5, 0, 0, 1]");
}

TEST(Pose, IsFiniteUntilArithmeticOverflows) {
  const Pose far(Eigen::Vector3d(0, 1.5e308, 0));
  EXPECT_TRUE(IsFinite(Pose()));
  EXPECT_TRUE(IsFinite(far));
  EXPECT_FALSE(IsFinite(far * far));
}

TEST(Pose, PrintsItsNumbers) {
  std::ostringstream out;
  out << Pose({0.1, 0, -2}, Quaternion{0.6, 0, 0, 0.8});
  EXPECT_EQ(out.str(), "Pose(translation=[0.1, 0, -2], quaternion=[0.6, 0, 0, 0.8])");
}

}  // namespace
}  // namespace robocell
