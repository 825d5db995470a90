#include "robocell/kinematics/ik_targets.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

std::vector<double> MatricesOf(const std::vector<Pose>& poses) {
  std::vector<double> numbers;
  for (const Pose& pose : poses) {
    const Eigen::Matrix4d m = pose.matrix();
    for (int r = 0; r < 4; ++r) {
      for (int c = 0; c < 4; ++c) numbers.push_back(m(r, c));
    }
  }
  return numbers;
}

std::vector<Pose> RandomPoses(int count) {
  Rng rng = Rng::Stream(7, "targets");
  std::vector<Pose> poses;
  for (int b = 0; b < count; ++b) {
    const Eigen::Vector3d p(rng.Uniform(-2, 2), rng.Uniform(-2, 2), rng.Uniform(-2, 2));
    poses.emplace_back(p, RandomQuaternion(rng));
  }
  return poses;
}

double Difference(const Transform& a, const Transform& b) {
  return (a.rotation - b.rotation).norm() + (a.translation - b.translation).norm();
}

TEST(IkTargets, AreTheSameFromPosesAndMatrices) {
  const std::vector<Pose> poses = RandomPoses(1000);
  const std::vector<double> numbers = MatricesOf(poses);
  const IkTargets targets(poses), matrices = IkTargets::FromMatrices(numbers);
  ASSERT_EQ(targets.size(), poses.size());
  ASSERT_EQ(matrices.size(), poses.size());
  for (std::size_t b = 0; b < poses.size(); ++b) {
    EXPECT_EQ(Difference(targets[b], ToTransform(poses[b])), 0);
    EXPECT_LT(Difference(matrices[b], ToTransform(poses[b])), 1e-14);
  }
  EXPECT_TRUE(IkTargets().empty());
  EXPECT_TRUE(IkTargets::FromMatrices({}).empty());
}

TEST(IkTargets, NormalisesRotationsLikePose) {
  std::vector<double> matrices = MatricesOf(RandomPoses(1));
  for (const double off : {1e-7, 1e-9, 1e-12}) {
    for (const int entry : {0, 1, 2, 4, 5, 6, 8, 9, 10}) {
      std::vector<double> bent = matrices;
      bent[entry] += off;
      const Eigen::Matrix3d r = IkTargets::FromMatrices(bent)[0].rotation;
      EXPECT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 1e-14) << off;
    }
  }
}

TEST(IkTargets, EachIsIndependentOfTheOthers) {
  std::vector<double> matrices = MatricesOf(RandomPoses(20));
  const std::vector<double> bent = [&] {
    std::vector<double> some = matrices;
    some[0] += 1e-8;
    return some;
  }();
  const IkTargets exact = IkTargets::FromMatrices(matrices), mixed = IkTargets::FromMatrices(bent);
  for (std::size_t b = 1; b < exact.size(); ++b) EXPECT_EQ(Difference(exact[b], mixed[b]), 0) << b;
  EXPECT_NE(Difference(exact[0], mixed[0]), 0);
}

TEST(IkTargets, ReadsRowMajorMatricesAndNamesAnInvalidOne) {
  std::vector<double> matrices = {1, 0, 0, 5, 0, 0, -1, 6, 0, 1, 0, 7, 0, 0, 0, 1,
                                  1, 0, 0, 5, 0, 1, 0,  6, 0, 0, 1, 7, 0, 0, 0, 1};
  const IkTargets targets = IkTargets::FromMatrices(matrices);
  ASSERT_EQ(targets.size(), 2u);
  EXPECT_EQ(targets[0].translation, Eigen::Vector3d(5, 6, 7));
  EXPECT_NEAR(targets[0].pose().rpy()[0], std::acos(0), 1e-12);
  const auto refused = [&](int entry, double value, const char* message) {
    std::vector<double> wrong = matrices;
    wrong[entry] = value;
    ExpectThrow<ArgumentError>([&] { IkTargets::FromMatrices(wrong, "goals"); }, message);
  };
  refused(16, 2, "goals[1]: ");
  refused(16, NAN, "goals[1]: ");
  refused(16, -1, "goals[1]: rotation matrix has determinant -1");
  refused(16 + 3, INFINITY, "goals[1]: pose: the translation [inf, 6, 7] is not finite");
  refused(31, 2, "goals[1]: ");
  refused(12, 1, "goals[0]: ");
  matrices.pop_back();
  ExpectThrow<ArgumentError>([&] { IkTargets::FromMatrices(matrices); },
                             "targets: expected 16 values for each 4x4 matrix, got 31");
}

}  // namespace
}  // namespace robocell
