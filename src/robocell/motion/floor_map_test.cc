#include "robocell/motion/floor_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/base/rng.h"

namespace robocell::internal {
namespace {

using Box = Eigen::AlignedBox2d;

// A robot as long as 0.6 m and as wide as 0.4 m among boxes that are aligned with the axes.
struct Floor {
  std::vector<Box> boxes;
  Eigen::Vector2d half = {0.3, 0.2};

  // By the separating axes of both rectangles.
  bool IsFree(const FloorPlace& at, double margin = 0) const {
    const double c = std::cos(at.yaw), s = std::sin(at.yaw);
    const Eigen::Vector2d h = half.array() + margin;
    return std::ranges::none_of(boxes, [&](const Box& box) {
      const Eigen::Vector2d between = box.center() - Eigen::Vector2d(at.x, at.y);
      const Eigen::Vector2d b = box.sizes() / 2;
      const double ac = std::abs(c), as = std::abs(s);
      return std::abs(between.x()) < b.x() + ac * h.x() + as * h.y() &&
             std::abs(between.y()) < b.y() + as * h.x() + ac * h.y() &&
             std::abs(c * between.x() + s * between.y()) < h.x() + ac * b.x() + as * b.y() &&
             std::abs(-s * between.x() + c * between.y()) < h.y() + as * b.x() + ac * b.y();
    });
  }
  FloorMap Map(bool drives_sideways = true) const {
    constexpr double kMargin = 0.05;
    FloorMap map({.bounds = Box(Eigen::Vector2d(-3, -3), Eigen::Vector2d(3, 3)),
                  .radius = half.norm() + kMargin,
                  .drives_sideways = drives_sideways},
                 [this](const FloorPlace& place) { return IsFree(place, kMargin); });
    for (const Box& box : boxes) {
      const Eigen::Vector2d &a = box.min(), &b = box.max();
      map.Block({a, {b.x(), a.y()}, b, {a.x(), b.y()}});
    }
    return map;
  }
};

Box BoxAt(double x, double y, double half_x, double half_y) {
  return {Eigen::Vector2d(x - half_x, y - half_y), Eigen::Vector2d(x + half_x, y + half_y)};
}

// The way turns or drives, never both at once, and is free all along.
void ExpectSound(const Floor& floor, const std::vector<FloorPlace>& way, bool drives_sideways) {
  for (size_t i = 1; i < way.size(); ++i) {
    const FloorPlace &a = way[i - 1], &b = way[i];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const double turn = std::remainder(b.yaw - a.yaw, 2 * M_PI);
    EXPECT_TRUE(length < 1e-9 || std::abs(turn) < 1e-9) << i;
    if (!drives_sideways && length > 0.12) {  // to and from the middle of a cell it may
      EXPECT_NEAR(std::sin(std::atan2(b.y - a.y, b.x - a.x) - a.yaw), 0, 1e-6) << i;
    }
    for (int s = 0; s <= 60; ++s) {
      const double t = s / 60.0;
      const FloorPlace at{std::lerp(a.x, b.x, t), std::lerp(a.y, b.y, t), a.yaw + t * turn};
      EXPECT_TRUE(floor.IsFree(at)) << i << ": " << at.x << " " << at.y << " " << at.yaw;
    }
  }
}

TEST(FloorMap, WaysOverRandomFloorsAreFreeAndEndWhereTheyShould) {
  int found = 0;
  double detour = 0;
  for (int seed = 0; seed < 10; ++seed) {
    Rng rng = Rng::Stream(seed, "floor");
    Floor floor;
    for (int i = 0; i < 14; ++i) {
      floor.boxes.push_back(BoxAt(rng.Uniform(-2.5, 2.5), rng.Uniform(-2.5, 2.5),
                                  rng.Uniform(0.05, 0.4), rng.Uniform(0.05, 0.4)));
    }
    const auto draw = [&] {
      FloorPlace place;
      do {
        place = {rng.Uniform(-2.5, 2.5), rng.Uniform(-2.5, 2.5), rng.Uniform(-3, 3)};
      } while (!floor.IsFree(place, 0.1));
      return place;
    };
    const FloorPlace start = draw();
    const std::vector<FloorPlace> goals = {draw(), draw()};
    const bool sideways = seed % 2 == 0;
    FloorMap map = floor.Map(sideways);
    const auto way = map.FindWay(start, goals);
    if (!way) continue;
    ++found;
    ExpectSound(floor, *way, sideways);
    EXPECT_EQ(way->front().x, start.x);
    EXPECT_EQ(way->front().yaw, start.yaw);
    const auto is_end = [&](const FloorPlace& goal) {
      return std::hypot(goal.x - way->back().x, goal.y - way->back().y) < 1e-9 &&
             std::abs(std::remainder(goal.yaw - way->back().yaw, 2 * M_PI)) < 1e-9;
    };
    EXPECT_TRUE(std::ranges::any_of(goals, is_end));
    const double straight = std::hypot(way->back().x - start.x, way->back().y - start.y);
    EXPECT_GE(LengthOf(*way), straight - 1e-9);
    detour += LengthOf(*way) / straight;
  }
  EXPECT_GT(found, 6);
  EXPECT_LT(detour / found, 1.6);
}

// Two walls with a gap between them, which a robot of 0.4 m passes or not.
TEST(FloorMap, PassesAGapExactlyIfTheRobotFits) {
  for (const double gap : {0.44, 0.7}) {
    Floor floor;
    const double half = (3 - gap / 2) / 2;
    floor.boxes = {BoxAt(0, gap / 2 + half, 0.05, half), BoxAt(0, -gap / 2 - half, 0.05, half)};
    FloorMap map = floor.Map();
    const auto way = map.FindWay({-2, 1, 0}, std::array{FloorPlace{2, 1, 0}});
    EXPECT_EQ(way.has_value(), gap > 0.6) << gap;
    if (way) ExpectSound(floor, *way, true);
  }
}

TEST(FloorMap, OnAFreeFloorTheWayIsStraightAndHasNoMoreThanTwoTurns) {
  const Floor empty;
  FloorMap map = empty.Map();
  const auto way = map.FindWay({-2, -2, 3}, std::array{FloorPlace{2, 1, -1}});
  ASSERT_TRUE(way);
  EXPECT_EQ(way->size(), 4U);
  EXPECT_NEAR(LengthOf(*way), 5, 1e-9);
  EXPECT_FALSE(map.FindWay({-2, -2, 3}, std::array{FloorPlace{5, 1, -1}})) << "beside the floor";
}

TEST(FloorMap, TheRoomIsNeverMoreThanTheDistanceToWhatStandsThere) {
  Floor floor;
  floor.boxes = {BoxAt(0.3, -0.2, 0.4, 0.1), BoxAt(-2, 1, 0.05, 0.6)};
  FloorMap map = floor.Map();
  Rng rng = Rng::Stream(1, "room");
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d at(rng.Uniform(-3, 3), rng.Uniform(-3, 3));
    double distance = HUGE_VAL;
    for (const Box& box : floor.boxes) distance = std::min(distance, box.exteriorDistance(at));
    const double room = map.RoomAt(at.x(), at.y());
    EXPECT_LE(room, distance + 1e-9);
    EXPECT_GE(room, distance - 0.3);
  }
}

}  // namespace
}  // namespace robocell::internal
