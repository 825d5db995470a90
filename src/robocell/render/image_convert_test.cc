#include "robocell/render/image_convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace robocell::internal {
namespace {

using testing::ElementsAre;

TEST(ImageConvert, RowsAreReversedForOddAndEvenCounts) {
  std::vector<uint8_t> three = {1, 2, 3, 4, 5, 6};
  FlipRows(std::span(three), 2);
  EXPECT_THAT(three, ElementsAre(5, 6, 3, 4, 1, 2));
  std::vector<float> two = {1, 2, 3, 4};
  FlipRows(std::span(two), 2);
  EXPECT_THAT(two, ElementsAre(3, 4, 1, 2));
}

TEST(ImageConvert, LooksUpIdsAndMapsUnknownOnesToMinusOne) {
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
}  // namespace robocell::internal
