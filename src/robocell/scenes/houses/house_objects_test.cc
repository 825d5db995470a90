#include "robocell/scenes/houses/house_objects.h"

#include <gtest/gtest.h>

#include <string>

namespace robocell::internal {
namespace {

TEST(HouseObjects, ObjectsHaveWordsAndSizes) {
  for (const std::string& kind : HouseObjectKinds()) {
    Rng rng = Rng::Stream(5, kind);
    const HouseThing thing = MakeHouseObject(kind, rng);
    EXPECT_FALSE(thing.words.empty());
    EXPECT_TRUE((thing.size.array() > 0.005).all()) << kind;
    EXPECT_TRUE((thing.size.array() < 0.5).all()) << kind;
    EXPECT_TRUE(thing.body.is_free);
  }
}

TEST(HouseObjects, RoomsHaveObjectsOfTheirOwn) {
  for (const auto& [room, name] : kRoomKinds) {
    const std::vector<std::string> kinds = HouseObjectsOf(room);
    EXPECT_GE(kinds.size(), 4U) << name;
    for (const std::string& kind : kinds) {
      Rng rng = Rng::Stream(1, kind);
      EXPECT_EQ(MakeHouseObject(kind, rng).category, kind);
    }
  }
}

}  // namespace
}  // namespace robocell::internal
