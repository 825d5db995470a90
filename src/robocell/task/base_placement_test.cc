#include "robocell/task/base_placement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace robocell {
namespace {

BaseRange Ranges() {
  BaseRange task;
  task.distance = {0.3, 0.7};
  task.height_offset = -0.2;
  task.height_noise = {-0.1, 0.1};
  return task;
}

BasePlacement Place(uint64_t turn, int attempt) {
  Rng rng = Rng::Stream(1, "placement", static_cast<int>(turn), attempt);
  return SpreadBasePlacement(Ranges(), 7, turn, attempt, rng);
}

TEST(BasePlacement, EveryQuarterOfTheRangesHasItsShareOfTheTurns) {
  std::vector<int> distances(4), heights(4);
  for (uint64_t turn = 0; turn < 40; ++turn) {
    const BasePlacement place = Place(turn, 0);
    ++distances.at(static_cast<size_t>((place.distance - 0.3) / 0.1));
    ++heights.at(static_cast<size_t>((place.height + 0.3) / 0.05));
  }
  for (int quarter = 0; quarter < 4; ++quarter) {
    EXPECT_NEAR(distances[quarter], 10, 2) << quarter;
    EXPECT_NEAR(heights[quarter], 10, 2) << quarter;
  }
}

TEST(BasePlacement, FurtherAttemptsSpreadAndStayInTheRanges) {
  double near = 0, far = 0;
  for (uint64_t turn = 0; turn < 50; ++turn) {
    const double first = Place(turn, 0).distance;
    near = std::max(near, std::abs(Place(turn, 1).distance - first));
    for (int attempt = 1; attempt < 20; ++attempt) {
      const BasePlacement place = Place(turn, attempt);
      EXPECT_GE(place.distance, 0.3);
      EXPECT_LE(place.distance, 0.7);
      EXPECT_GE(place.height, -0.3);
      EXPECT_LE(place.height, -0.1);
      far = std::max(far, std::abs(place.distance - first));
    }
  }
  EXPECT_LE(near, 0.15 * 0.4 + 1e-9);
  EXPECT_GE(far, 0.5 * 0.4);
}

}  // namespace
}  // namespace robocell
