#include <gtest/gtest.h>

#include <algorithm>

#include "robocell/scenes/houses/furniture.h"

namespace robocell::internal {
namespace {

int Containers(const HouseBody& body) {
  int count = static_cast<int>(std::ranges::count(body.slots, true, &HouseSlot::is_container));
  for (const HouseBody& child : body.children) count += Containers(child);
  return count;
}

TEST(KitchenFurniture, HasContainersBehindItsFronts) {
  Rng rng = Rng::Stream(1, "kitchen");
  EXPECT_EQ(Containers(MakeCounter(rng, true).body), 3);   // drawers
  EXPECT_EQ(Containers(MakeCounter(rng, false).body), 2);  // shelves
  EXPECT_EQ(Containers(MakeSink(rng).body), 1);            // the basin
  EXPECT_EQ(Containers(MakeStove(rng).body), 1);           // the oven
  EXPECT_EQ(Containers(MakeFridge(rng).body), 3);
  EXPECT_EQ(Containers(MakeWallCupboard(rng).body), 1);
}

TEST(KitchenFurniture, UnitsOfARowHaveOneHeight) {
  Rng rng = Rng::Stream(2, "kitchen");
  const double height = MakeCounter(rng, true).size.z();
  EXPECT_EQ(MakeCounter(rng, false).size.z(), height);
  EXPECT_EQ(MakeSink(rng).size.z(), height);
  EXPECT_EQ(MakeStove(rng).size.z(), height);
}

}  // namespace
}  // namespace robocell::internal
