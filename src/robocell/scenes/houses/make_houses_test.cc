#include "robocell/scenes/houses/make_houses.h"

#include <gtest/gtest.h>

#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

TEST(MakeHouses, TheSameHouseHasTheSameBytes) {
  const TempDir a, b;
  const HouseOptions options{.seed = 4, .most_objects = 6, .kinds = {internal::RoomKind::kOffice}};
  for (const TempDir* folder : {&a, &b}) {
    PrepareHouseFolder(folder->path(), options);
    EXPECT_FALSE(HasHouse(folder->path(), options, 2));
    const HouseSummary house = MakeHouseFiles(folder->path(), options, 2);
    EXPECT_EQ(house.name, "train_2");
    EXPECT_EQ(house.rooms, 1);
    EXPECT_GT(house.objects, 2);
    EXPECT_TRUE(HasHouse(folder->path(), options, 2));
  }
  for (const char* name :
       {"train_2.xml", "train_2_ceiling.xml", "train_2_map.png", "train_2_metadata.json"})
    EXPECT_EQ(ReadFile(a / name), ReadFile(b / name)) << name;
}

TEST(MakeHouses, OptionsHaveBounds) {
  ExpectThrow<ArgumentError>([] { PlanHouse({.least_rooms = 300, .most_rooms = 300}, 0); },
                             "rooms: 300 to 300; give 1 to 40");
  ExpectThrow<ArgumentError>([] { PlanHouse({.least_rooms = 4, .most_rooms = 3}, 0); }, "4 to 3");
  ExpectThrow<ArgumentError>([] { PlanHouse({.most_objects = -1}, 0); }, "give 0 to 1000");
  ExpectThrow<ArgumentError>(
      [] { PlanHouse({.kinds = std::vector(41, internal::RoomKind::kOffice)}, 0); },
      "kinds: 41 rooms");
  ExpectThrow<ArgumentError>([] { PrepareHouseFolder("/nowhere", {.prefix = "../"}); }, "prefix");
}

TEST(MakeHouses, AFolderHasHousesOfOneSeed) {
  const TempDir folder;
  PrepareHouseFolder(folder.path(), {.seed = 1});
  PrepareHouseFolder(folder.path(), {.seed = 1});
  ExpectThrow<ArgumentError>([&] { PrepareHouseFolder(folder.path(), {.seed = 2}); },
                             "houses of other options");
}

}  // namespace
}  // namespace robocell
