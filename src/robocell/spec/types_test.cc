#include "robocell/spec/types.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/specs.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ParseError;
using testing::ValidationError;

TEST(Placement, EulerIsInDegreesAboutFixedAxes) {
  const Pose pose = PlacementPose({1, 2, 3}, {10, 20, 30}, kIdentityQuat);
  const Pose expected =
      Pose::FromRpy({1, 2, 3}, Eigen::Vector3d(10, 20, 30) * std::numbers::pi / 180);
  EXPECT_TRUE(pose.is_close(expected, 1e-12, 1e-12));
}

TEST(Placement, QuatAndEulerExcludeEachOther) {
  SceneObject object = Cube("a");
  object.euler = {0, 0, 90};
  object.quat = {1, 0, 0, 0};
  EXPECT_THAT(ValidationError(object), HasSubstr("quat: both quat and euler are set; keep one"));
}

}  // namespace
}  // namespace robocell
