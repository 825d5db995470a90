#include "robocell/scenes/houses/make_houses.h"

#include <gtest/gtest.h>

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

TEST(MakeHouses, AFolderHasHousesOfOneSeed) {
  const TempDir folder;
  PrepareHouseFolder(folder.path(), {.seed = 1});
  PrepareHouseFolder(folder.path(), {.seed = 1});
  ExpectThrow<ArgumentError>([&] { PrepareHouseFolder(folder.path(), {.seed = 2}); },
                             "houses of other options");
}

}  // namespace
}  // namespace robocell
