#include "robocell/kinematics/pose_error.h"

#include <gtest/gtest.h>

namespace robocell::internal {
namespace {

TEST(PoseError, RecoversRotationVectorsAndTheirLengths) {
  const Eigen::Vector3d axis = Eigen::Vector3d(0.3, -0.8, 0.5).normalized();
  for (const double angle : {0.0, 1e-12, 1e-6, 9.99e-4, 1.01e-3, 0.3, 1.6, 3.1, 3.14159}) {
    const Eigen::Matrix3d r = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    const double rounding = angle > 3 ? 1e-8 : 1e-15;  // of the cosine, where it is steep
    EXPECT_NEAR(RotationAngle(r), angle, rounding) << angle;
    EXPECT_NEAR(RotationVector(r).norm(), RotationAngle(r), 4e-16 * (1 + angle)) << angle;
    EXPECT_LT((RotationVector(r) - angle * axis).norm(), rounding) << angle;
  }
}

}  // namespace
}  // namespace robocell::internal
