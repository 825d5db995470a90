#include "robocell/render/image_convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace robocell {
namespace {

using testing::ElementsAre;
using testing::FloatNear;

TEST(ImageConvert, RowsAreReversedForOddAndEvenCounts) {
  std::vector<uint8_t> three = {1, 2, 3, 4, 5, 6};
  FlipRows(std::span(three), 2);
  EXPECT_THAT(three, ElementsAre(5, 6, 3, 4, 1, 2));
  std::vector<float> two = {1, 2, 3, 4};
  FlipRows(std::span(two), 2);
  EXPECT_THAT(two, ElementsAre(3, 4, 1, 2));
}

TEST(ImageConvert, RawDepthIsTheNearPlaneAtOneAndNothingAtZero) {
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

TEST(ImageConvert, MillimetresAreRoundedAndSaturate) {
  const std::vector<float> metres = {0, 0.0004f, 0.0016f, 1.2344f, 65.534f, 65.6f, 1000};
  std::vector<uint16_t> mm(metres.size());
  MetresToMillimetres(metres, mm);
  EXPECT_THAT(mm, ElementsAre(0, 0, 2, 1234, 65534, 65535, 65535));
}

TEST(ImageConvert, IdsAreLookedUpAndUnknownOnesAreNone) {
  const std::vector<int32_t> table(300, 7);
  std::vector<int32_t> some = table;
  some[0] = 3;
  some[299] = 9;
  const std::vector<uint8_t> rgb = {0, 0, 0, 1, 0, 0, 300 % 256, 1, 0, 45, 1, 0, 255, 255, 255};
  std::vector<int32_t> ids(5);
  DecodeIds(rgb, some, ids);
  EXPECT_THAT(ids, ElementsAre(-1, 3, 9, -1, -1));
}

}  // namespace
}  // namespace robocell
