#include "robocell/scenes/houses/floor_plan.h"

#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <vector>

namespace robocell::internal {
namespace {

TEST(FloorPlan, DoorsConnectAllRooms) {
  for (int i = 0; i < 60; ++i) {
    Rng rng = Rng::Stream(1, "plan", i);
    const FloorPlan plan = MakeFloorPlan({.rooms = 1 + i % 7}, rng);
    std::vector<int> group(plan.rooms.size());
    std::iota(group.begin(), group.end(), 0);
    const std::function<int(int)> root = [&](int room) {
      return group[static_cast<size_t>(room)] == room ? room
                                                      : root(group[static_cast<size_t>(room)]);
    };
    for (const PlanWall& wall : plan.walls) {
      for (const PlanOpening& opening : wall.openings) {
        EXPECT_GE(opening.at - opening.width / 2, 0);
        EXPECT_LE(opening.at + opening.width / 2, wall.length);
        if (opening.is_door && wall.below >= 0 && wall.above >= 0)
          group[static_cast<size_t>(root(wall.below))] = root(wall.above);
      }
    }
    for (size_t room = 0; room < plan.rooms.size(); ++room)
      EXPECT_EQ(root(static_cast<int>(room)), root(0)) << "plan " << i << ", room " << room;
    double area = 0;
    for (const PlanRoom& room : plan.rooms) area += room.outer.volume();
    EXPECT_NEAR(area, plan.outline.volume(), 1e-6);
  }
}

TEST(FloorPlan, RoomsHaveTheKindsThatAreAskedFor) {
  Rng rng = Rng::Stream(2, "plan");
  const FloorPlan plan =
      MakeFloorPlan({.rooms = 2, .kinds = {RoomKind::kWarehouse, RoomKind::kOffice}}, rng);
  ASSERT_EQ(plan.rooms.size(), 2U);
  EXPECT_EQ(plan.rooms[0].name, "room_1_warehouse");
  EXPECT_EQ(plan.rooms[1].name, "room_2_office");
  EXPECT_GE(plan.rooms[0].outer.volume(), plan.rooms[1].outer.volume());
}

}  // namespace
}  // namespace robocell::internal
