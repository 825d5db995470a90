#include "robocell/scenes/houses/house_metadata.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

TEST(HouseMetadata, RoundTrips) {
  HouseMetadata metadata;
  metadata.objects["Mug|1"] = {.category = "Mug",
                               .asset = "Mug_2",
                               .id = "Mug|1",
                               .parent = "table_1",
                               .children = {"spoon"},
                               .words = {"the red mug"},
                               .room = 3,
                               .joints = {{"hinge", "hinge_0"}}};
  const TempDir folder;
  AtomicWrite(folder / "m.json", HouseMetadataText(metadata));
  int ignored = -1;
  const HouseMetadata back = ReadHouseMetadata(folder / "m.json", &ignored);
  EXPECT_EQ(ignored, 0);
  EXPECT_EQ(HouseMetadataText(back), HouseMetadataText(metadata));
  EXPECT_EQ(back.objects.at("Mug|1").room, 3);
}

TEST(HouseMetadata, CountsWhatItCannotRead) {
  const TempDir folder;
  AtomicWrite(
      folder / "m.json",
      R"({"objects": {"a": 1, "b": {"category": [], "room_id": "2", "children": [3, "c"]}}})");
  int ignored = 0;
  const HouseMetadata metadata = ReadHouseMetadata(folder / "m.json", &ignored);
  EXPECT_EQ(ignored, 4);
  EXPECT_EQ(metadata.objects.at("b").children, std::vector<std::string>{"c"});
}

TEST(HouseMetadata, RejectsWhatIsNoMetadata) {
  const TempDir folder;
  const auto reading = [&](const std::string& text) {
    AtomicWrite(folder / "m.json", text);
    return [&] { ReadHouseMetadata(folder / "m.json"); };
  };
  ExpectThrow<IoError>(reading("{"), "not JSON");
  ExpectThrow<IoError>(reading("[]"), "not an object with the key `objects`");
  ExpectThrow<IoError>(reading(R"({"objects": []})"), "not an object of objects");
  ExpectThrow<IoError>(reading(std::string(100'000, '[')), "nested deeper");
}

TEST(HouseMetadata, WordsOfCategoriesAreSplit) {
  EXPECT_EQ(WordsOfCategory("RemoteControl"), "remote control");
  EXPECT_EQ(WordsOfCategory("coffee_machine"), "coffee machine");
  EXPECT_EQ(WordsOfCategory("TVStand"), "tvstand");
  EXPECT_EQ(WordsOfCategory(""), "");
}

}  // namespace
}  // namespace robocell::internal
