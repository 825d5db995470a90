#include "robocell/render/depth_conversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace robocell::internal {
namespace {

using testing::ElementsAre;
using testing::FloatNear;

TEST(DepthConversion, RawDepthIsTheNearPlaneAtOneAndInfinityAtZero) {
  CameraModel camera;
  camera.near_m = 0.1;
  camera.far_m = 10;
  const double raw_of_two = (0.1 * 10 / 2 - 0.1) / (10 - 0.1);
  std::vector<float> depth = {1, static_cast<float>(raw_of_two), 0};
  RawDepthToMetres(depth, camera);
  EXPECT_THAT(depth, ElementsAre(FloatNear(0.1f, 1e-7f), FloatNear(2, 1e-6f), 0));
  camera.orthographic = true;
  depth = {1, 0.5, 0};
  RawDepthToMetres(depth, camera);
  EXPECT_THAT(depth, ElementsAre(FloatNear(0.1f, 1e-6f), FloatNear(5.05f, 1e-6f), 0));
}

TEST(DepthConversion, MillimetresAreRoundedAndSaturate) {
  const std::vector<float> metres = {0, 0.0004f, 0.0016f, 1.2344f, 65.534f, 65.6f, 1000};
  std::vector<uint16_t> mm(metres.size());
  MetresToMillimetres(metres, mm);
  EXPECT_THAT(mm, ElementsAre(0, 0, 2, 1234, 65534, 65535, 65535));
}

}  // namespace
}  // namespace robocell::internal
