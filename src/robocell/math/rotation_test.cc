#include "robocell/math/rotation.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr int kCases = 3000;

// A rotation of exactly this angle, by Eigen.
Matrix3d EigenRotation(const Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

double Distance(const Matrix3d& a, const Matrix3d& b) { return (a - b).cwiseAbs().maxCoeff(); }

double Distance(const Quaternion& a, const Quaternion& b) {
  double largest = 0;
  for (int i = 0; i < 4; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(Rotation, MatricesMatchEigen) {
  Rng rng = Rng::Stream(1, "matrices");
  for (int i = 0; i < kCases; ++i) {
    const Quaternion q = RandomQuaternion(rng);
    const Matrix3d expected = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix();
    ASSERT_LT(Distance(MatrixFromQuaternion(q), expected), 1e-15);
    ASSERT_LT(Distance(QuaternionFromMatrix(expected), q), 1e-15);
  }
}

TEST(Rotation, ProductsAndInversesMatchMatrices) {
  Rng rng = Rng::Stream(1, "products");
  for (int i = 0; i < kCases; ++i) {
    const Quaternion a = RandomQuaternion(rng), b = RandomQuaternion(rng);
    const Matrix3d ra = MatrixFromQuaternion(a), rb = MatrixFromQuaternion(b);
    const Vector3d v = RandomVector(rng);
    ASSERT_LT(Distance(MatrixFromQuaternion(QuaternionProduct(a, b)), ra * rb), 2e-15);
    ASSERT_LT(Distance(MatrixFromQuaternion(QuaternionInverse(a)), ra.transpose()), 1e-15);
    ASSERT_LT((Rotate(a, v) - ra * v).norm(), 2e-15);
    ASSERT_LT(Distance(QuaternionProduct(a, QuaternionInverse(a)), {0, 0, 0, 1}), 1e-15);
  }
}

TEST(Rotation, AMillionProductsStayOfUnitLength) {
  Rng rng = Rng::Stream(1, "drift");
  const Quaternion step = RandomQuaternion(rng);
  Quaternion q = step;
  for (int i = 0; i < 1000000; ++i) q = QuaternionProduct(q, step);
  EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 3e-15);
}

TEST(Rotation, ResultsAreCanonicalAndKeepTheirBitsWhenCheckedAgain) {
  Rng rng = Rng::Stream(1, "canonical");
  for (int i = 0; i < kCases; ++i) {
    const Quaternion a = RandomQuaternion(rng), b = RandomQuaternion(rng);
    for (const Quaternion& q :
         {a, QuaternionProduct(a, b), QuaternionInverse(a), Slerp(a, b, 0.3),
          QuaternionFromRotvec(RandomVector(rng, 5)), QuaternionFromRpy(RandomVector(rng, 5))}) {
      ASSERT_GE(q[3], 0);
      ASSERT_EQ(UnitQuaternion(q), q);
      ASSERT_EQ(UnitQuaternion({-q[0], -q[1], -q[2], -q[3]}), q);
    }
  }
}

TEST(Rotation, HalfTurnsHaveOneSign) {
  EXPECT_EQ(UnitQuaternion({-1, 0, 0, 0}), (Quaternion{1, 0, 0, 0}));
  EXPECT_EQ(UnitQuaternion({0, -0.6, 0.8, 0}), (Quaternion{0, 0.6, -0.8, 0}));
  EXPECT_EQ(UnitQuaternion({0, 0, -1, -0.0}), (Quaternion{0, 0, 1, 0}));
  EXPECT_FALSE(std::signbit(UnitQuaternion({0, 0, -1, 0})[0]));  // no "-0" in files and messages
}

TEST(Rotation, QuaternionsWithinOneMillionthAreNormalised) {
  for (const double length : {1 - 0.99e-6, 1 + 0.99e-6}) {
    const Quaternion q = UnitQuaternion({0.6 * length, 0, 0, 0.8 * length});
    EXPECT_LT(Distance(q, {0.6, 0, 0, 0.8}), 1e-15);
  }
}

TEST(Rotation, RejectsOtherQuaternions) {
  ExpectThrow<ArgumentError>(
      [] {
        UnitQuaternion({0, 0, 0, 0.5});
      },
      "quaternion [0, 0, 0, 0.5] (xyzw) has length 0.5, not 1. Divide it by "
      "its length first.");
  ExpectThrow<ArgumentError>([] { UnitQuaternion({0, 0, 0, 0}); }, "has length 0, not 1");
  ExpectThrow<ArgumentError>([] { UnitQuaternion({0, 0, 0, 1 + 1.01e-6}); }, "not 1");
  ExpectThrow<ArgumentError>([] { UnitQuaternion({NAN, 0, 0, 1}); }, "[nan, 0, 0, 1]");
  ExpectThrow<ArgumentError>([] { UnitQuaternion({0, INFINITY, 0, 1}); }, "has length inf");
}

TEST(Rotation, TheOrderOfMujocoIsWxyz) {
  const double wxyz[4] = {0.8, 0.6, 0, 0};
  const Quaternion q = QuaternionFromWxyz(wxyz);
  EXPECT_EQ(q, (Quaternion{0.6, 0, 0, 0.8}));
  EXPECT_EQ(QuaternionToWxyz(q), (Quaternion{0.8, 0.6, 0, 0}));
}

TEST(Rotation, RejectsMatricesThatAreNotRotations) {
  Matrix3d scaled = Matrix3d::Identity();
  scaled(0, 0) = 1.1;
  ExpectThrow<ArgumentError>([&] { QuaternionFromMatrix(scaled); },
                             "not orthonormal: R^T * R differs from the identity by 0.21");
  ExpectThrow<ArgumentError>([] { QuaternionFromMatrix(-Matrix3d::Identity()); },
                             "determinant -1: it mirrors. Flip one of its axes.");
  Matrix3d nan = Matrix3d::Identity();
  nan(1, 1) = NAN;
  ExpectThrow<ArgumentError>([&] { QuaternionFromMatrix(nan); }, "rotation matrix is not finite");
  const Matrix3d nearly = Matrix3d::Identity() * (1 + 4e-7);
  EXPECT_EQ(QuaternionFromMatrix(nearly), (Quaternion{0, 0, 0, 1}));
}

TEST(Rotation, RotationVectorsRoundTripEveryAngle) {
  Rng rng = Rng::Stream(1, "rotvec");
  for (const double angle : {0.0, 1e-300, 1e-170, 1e-20, 1e-9, 0.99e-8, 1.01e-8, 1e-4, 0.1, 1.0,
                             3.0, kPi - 1e-4, kPi - 1e-9, kPi - 1e-15}) {
    for (int i = 0; i < 200; ++i) {
      const Vector3d rotvec = RandomDirection(rng) * angle;
      const Quaternion q = QuaternionFromRotvec(rotvec);
      ASSERT_LT((RotvecFromQuaternion(q) - rotvec).norm(), 3e-15 * std::max(angle, 1e-300))
          << angle;
      const Matrix3d expected = EigenRotation(rotvec.normalized(), angle);
      ASSERT_LT(Distance(MatrixFromQuaternion(q), expected), 2e-15) << angle;
    }
  }
}

TEST(Rotation, RotationVectorsBeyondPiBecomeTheShorterTurn) {
  Rng rng = Rng::Stream(1, "long rotvec");
  for (int i = 0; i < kCases; ++i) {
    const double angle = rng.Uniform(kPi, 20);
    const Vector3d axis = RandomDirection(rng);
    const Quaternion q = QuaternionFromRotvec(axis * angle);
    const Vector3d back = RotvecFromQuaternion(q);
    ASSERT_LE(back.norm(), kPi + 1e-15);
    ASSERT_LT(Distance(EigenRotation(axis, angle), EigenRotation(back.normalized(), back.norm())),
              1e-14);
  }
}

TEST(Rotation, RpyIsYawTimesPitchTimesRoll) {
  Rng rng = Rng::Stream(1, "rpy");
  for (int i = 0; i < kCases; ++i) {
    const Vector3d rpy = RandomVector(rng, 7);
    const Matrix3d expected = EigenRotation(Vector3d::UnitZ(), rpy[2]) *
                              EigenRotation(Vector3d::UnitY(), rpy[1]) *
                              EigenRotation(Vector3d::UnitX(), rpy[0]);
    ASSERT_LT(Distance(MatrixFromQuaternion(QuaternionFromRpy(rpy)), expected), 2e-15);
  }
}

TEST(Rotation, RpyRoundTripsInItsRanges) {
  Rng rng = Rng::Stream(1, "rpy back");
  for (int i = 0; i < kCases; ++i) {
    const Vector3d rpy(rng.Uniform(-3.1, 3.1), rng.Uniform(-1.5, 1.5), rng.Uniform(-3.1, 3.1));
    ASSERT_LT((RpyFromQuaternion(QuaternionFromRpy(rpy)) - rpy).norm(), 3e-14);
  }
}

TEST(Rotation, RpyRoundTripsNearGimbalLock) {
  Rng rng = Rng::Stream(1, "near lock");
  for (const double gap : {0.0, 1e-16, 1e-14, 1e-12, 2e-12, 1e-9, 1e-6, 1e-3}) {
    for (int i = 0; i < 500; ++i) {
      const double pitch = (kPi / 2 - gap) * (i % 2 ? 1 : -1);
      const Quaternion q =
          QuaternionFromRpy({rng.Uniform(-kPi, kPi), pitch, rng.Uniform(-kPi, kPi)});
      const Vector3d rpy = RpyFromQuaternion(q);
      ASSERT_LE(std::abs(rpy[1]), kPi / 2);
      ASSERT_LT(Distance(MatrixFromQuaternion(QuaternionFromRpy(rpy)), MatrixFromQuaternion(q)),
                4e-12)  // at most twice the width of the lock
          << gap;
    }
  }
}

TEST(Rotation, RollIsZeroAtGimbalLock) {
  const Vector3d up = RpyFromQuaternion(QuaternionFromRpy({0.3, kPi / 2, 0.5}));
  EXPECT_EQ(up[0], 0);
  EXPECT_NEAR(up[1], kPi / 2, 1e-12);
  EXPECT_NEAR(up[2], 0.5 - 0.3, 1e-14);
  const Vector3d down = RpyFromQuaternion(QuaternionFromRpy({0.3, -kPi / 2, 0.5}));
  EXPECT_EQ(down[0], 0);
  EXPECT_NEAR(down[2], 0.5 + 0.3, 1e-14);
}

TEST(Rotation, AngleBetweenIsAMetric) {
  Rng rng = Rng::Stream(1, "angle");
  for (int i = 0; i < kCases; ++i) {
    const Quaternion a = RandomQuaternion(rng), b = RandomQuaternion(rng),
                     c = RandomQuaternion(rng);
    const double oracle =
        Eigen::AngleAxisd(MatrixFromQuaternion(a).transpose() * MatrixFromQuaternion(b)).angle();
    ASSERT_NEAR(AngleBetween(a, b), oracle, 1e-7);
    ASSERT_NEAR(AngleBetween(a, b), AngleBetween(b, a), 1e-14);
    ASSERT_LT(AngleBetween(a, a), 1e-15);
    ASSERT_LE(AngleBetween(a, c), AngleBetween(a, b) + AngleBetween(b, c) + 1e-14);
    ASSERT_NEAR(AngleBetween(QuaternionProduct(c, a), QuaternionProduct(c, b)), AngleBetween(a, b),
                1e-14);
  }
}

TEST(Rotation, SlerpTurnsEvenlyAlongTheShorterArc) {
  Rng rng = Rng::Stream(1, "slerp");
  for (int i = 0; i < kCases; ++i) {
    const Quaternion a = RandomQuaternion(rng), b = RandomQuaternion(rng);
    const double s = rng.Uniform(), whole = AngleBetween(a, b);
    const Quaternion middle = Slerp(a, b, s);
    ASSERT_EQ(Slerp(a, b, 0), a);
    ASSERT_EQ(Slerp(a, b, 1), b);
    ASSERT_NEAR(AngleBetween(a, middle), s * whole, 3e-15);
    ASSERT_NEAR(AngleBetween(middle, b), (1 - s) * whole, 3e-15);
    const Eigen::Quaterniond ea(a[3], a[0], a[1], a[2]), eb(b[3], b[0], b[1], b[2]);
    ASSERT_LT(Distance(MatrixFromQuaternion(middle), ea.slerp(s, eb).toRotationMatrix()), 1e-14);
  }
}

TEST(Rotation, RandomRotationsHaveNoPreferredDirection) {
  Rng rng = Rng::Stream(1, "haar");
  Matrix3d mean = Matrix3d::Zero();
  double angle = 0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const Quaternion q = RandomQuaternion(rng);
    mean += MatrixFromQuaternion(q) / kDraws;
    angle += AngleBetween({0, 0, 0, 1}, q) / kDraws;
  }
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.02);
  EXPECT_NEAR(angle, kPi / 2 + 2 / kPi, 0.02);  // the mean angle of a uniformly random rotation
}

TEST(Rotation, SkewIsTheCrossProduct) {
  Rng rng = Rng::Stream(1, "skew");
  for (int i = 0; i < 100; ++i) {
    const Vector3d a = RandomVector(rng), b = RandomVector(rng);
    EXPECT_LT((Skew(a) * b - a.cross(b)).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace robocell
