#include "robocell/scenes/houses/house_annotations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "robocell/base/files.h"
#include "robocell/scenes/houses/house_map.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

TEST(HouseAnnotations, SupportsAreTheFreePartsOfFurniture) {
  const HouseFolder folder =
      HouseFolder::Find({.root = SourceDir() + "/tests/houses/scenes/procthor-10k-train"}, "");
  const HouseFiles& files = folder.houses().at(0);
  const Scene scene = Scene::Build({.base = files.model.string(), .timestep = 0.002});
  std::vector<std::string> notes;
  const SceneAnnotations house = AnnotateHouse(scene, files, notes);
  EXPECT_TRUE(notes.empty());
  const auto table = std::ranges::find(house.supports, "DiningTable|2|0|1", &SupportFace::body);
  ASSERT_NE(table, house.supports.end());
  EXPECT_EQ(table->room, "room|2");
  for (const char* name : {"Mug|2|2", "bowl_0123456789abcdef0123456789abcdef_1_0_2"}) {
    const Eigen::Vector3d at =
        table->face.frame_to_world.inverse() * scene.body_pose(name).translation();
    EXPECT_TRUE(std::abs(at.x()) > table->face.half_x || std::abs(at.y()) > table->face.half_y);
  }
}

TEST(HouseAnnotations, MissingFilesAreNoted) {
  const HouseFolder folder =
      HouseFolder::Find({.root = SourceDir() + "/tests/houses/scenes/procthor-10k-train"}, "");
  const Scene scene =
      Scene::Build({.base = folder.houses().at(0).model.string(), .timestep = 0.002});
  std::vector<std::string> notes;
  const SceneAnnotations house =
      AnnotateHouse(scene, {.model = folder.houses().at(0).model}, notes);
  EXPECT_EQ(notes.size(), 2U);
  EXPECT_TRUE(house.rooms.empty());
  EXPECT_FALSE(house.free_floor.empty());
}

// The map of a house, and the same one beside it.
TEST(HouseAnnotations, AMapOfAnotherHouseIsNotUsed) {
  const HouseFolder folder =
      HouseFolder::Find({.root = SourceDir() + "/tests/houses/scenes/procthor-10k-train"}, "");
  const HouseFiles& files = folder.houses().at(0);
  const Scene scene = Scene::Build({.base = files.model.string(), .timestep = 0.002});
  const HouseMap map = ReadHouseMap(files.map);
  const TempDir folder_of_map;
  for (const double shift : {0.0, 40.0}) {  // metres
    HouseMap moved = map;
    for (auto& row : moved.world_to_map) row[3] -= row[0] * shift;
    const std::vector<uint8_t> bytes = EncodeHouseMap(moved);
    AtomicWrite(folder_of_map / "map.png", std::string(bytes.begin(), bytes.end()));
    std::vector<std::string> notes;
    const SceneAnnotations house = AnnotateHouse(
        scene, {.model = files.model, .map = folder_of_map / "map.png", .metadata = files.metadata},
        notes);
    EXPECT_FALSE(house.free_floor.empty());
    EXPECT_EQ(house.rooms.empty(), shift > 0);
    if (shift > 0)
      EXPECT_THAT(notes,
                  testing::ElementsAre(testing::HasSubstr("not one of this house: only 0 %")));
    else
      EXPECT_TRUE(notes.empty());
  }
}

// What is free in the map is under a roof that is as level and as free as a floor.
TEST(HouseAnnotations, ARoofIsNotTheFloorOfAMap) {
  const TempDir folder;
  AtomicWrite(folder / "house.xml", R"(<mujoco><worldbody>
    <geom name="floor" type="box" size="4 4 0.1" pos="0 0 -0.1"/>
    <geom name="block" type="box" size="4 2 1.2" pos="0 2 1.2"/></worldbody></mujoco>)");
  const Scene scene = Scene::Build({.base = (folder / "house.xml").string(), .timestep = 0.002});
  for (const bool is_blocked : {false, true}) {
    HouseMap map = MakeHouseMap({-4, -4}, {4, 4}, 20);
    for (int row = 0; row < map.rows; ++row) {
      for (int column = 0; column < map.columns; ++column) {
        const double y = map.PositionOf(row, column).y();
        map.free[static_cast<size_t>(row) * static_cast<size_t>(map.columns) +
                 static_cast<size_t>(column)] = is_blocked ? y > 0.2 : y < -0.2;
      }
    }
    const std::vector<uint8_t> bytes = EncodeHouseMap(map);
    AtomicWrite(folder / "map.png", std::string(bytes.begin(), bytes.end()));
    std::vector<std::string> notes;
    AnnotateHouse(scene, {.model = folder / "house.xml", .map = folder / "map.png"}, notes);
    EXPECT_EQ(
        std::ranges::any_of(
            notes, [](const std::string& note) { return note.starts_with("its map is not"); }),
        is_blocked);
  }
}

}  // namespace
}  // namespace robocell::internal
