#include "robocell/scenes/houses/furnished_house.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "robocell/scenes/houses/furniture.h"
#include "robocell/scenes/houses/make_houses.h"

namespace robocell::internal {
namespace {

constexpr int kPlans = 60;

void CollectNames(const HouseBody& body, std::vector<std::string>& names) {
  names.push_back(body.name);
  if (body.joint) names.push_back(body.joint->name);
  for (const HousePart& part : body.parts) names.push_back(part.name);
  for (const HouseBody& child : body.children) CollectNames(child, names);
}

TEST(FurnishedHouse, FurnitureStandsInItsRoomAndClearOfDoors) {
  std::set<std::string> seen;
  for (int i = 0; i < kPlans; ++i) {
    const FurnishedHouse house = PlanHouse({.seed = 2}, i);
    EXPECT_GE(house.pieces.size(), house.plan.rooms.size()) << "plan " << i;
    for (const HousePiece& piece : house.pieces) {
      seen.insert(piece.thing.category);
      EXPECT_TRUE(house.plan.rooms[piece.room].inner().contains(piece.footprint))
          << piece.thing.body.name;
      for (const Eigen::AlignedBox2d& door : DoorAreas(house.plan, piece.room))
        EXPECT_LT(door.intersection(piece.footprint).sizes().minCoeff(), 2e-3)
            << piece.thing.body.name;
    }
  }
  for (const std::string& kind : FurnitureKinds())
    EXPECT_TRUE(seen.contains(kind)) << kind << " is in none of the plans";
}

TEST(FurnishedHouse, NamesAreUnique) {
  for (int i = 0; i < 10; ++i) {
    const FurnishedHouse house = PlanHouse({.seed = 3}, i);
    std::vector<std::string> names;
    for (const HousePiece& piece : house.pieces) CollectNames(piece.thing.body, names);
    for (const HousePiece& object : house.objects) CollectNames(object.thing.body, names);
    EXPECT_EQ(std::set(names.begin(), names.end()).size(), names.size());
  }
}

TEST(FurnishedHouse, EverySlotHoldsAnObject) {
  for (int i = 0; i < kPlans; ++i) {
    FurnishedHouse house = PlanHouse({.seed = 4, .most_objects = 25}, i);
    EXPECT_LE(house.objects.size(), 25U);
    EXPECT_FALSE(house.slots.empty());
    std::multiset<size_t> all;
    for (const FilledSlot& slot : house.slots) {
      EXPECT_FALSE(slot.objects.empty());
      all.insert(slot.objects.begin(), slot.objects.end());
    }
    EXPECT_EQ(all.size(), house.objects.size());
    EXPECT_EQ(std::set(all.begin(), all.end()).size(), house.objects.size());
    const std::string last = house.objects.back().thing.body.name;
    RemoveObjects(house, {0, 1});
    EXPECT_EQ(house.objects.back().thing.body.name, last);
    for (const FilledSlot& slot : house.slots) {
      EXPECT_FALSE(slot.objects.empty());
      for (const size_t object : slot.objects) EXPECT_LT(object, house.objects.size());
    }
  }
}

}  // namespace
}  // namespace robocell::internal
