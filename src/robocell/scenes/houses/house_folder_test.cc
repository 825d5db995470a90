#include "robocell/scenes/houses/house_folder.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

std::string Fixtures() { return SourceDir() + "/tests/houses"; }

void Touch(const fs::path& file) {
  fs::create_directories(file.parent_path());
  AtomicWrite(file, "<mujoco/>");
}

TEST(HouseFolder, FindsSetsBelowTheScenePath) {
  const ScopedEnv roots("ROBOCELL_SCENE_PATH", "/nowhere:" + Fixtures());
  const HouseFolder folder = HouseFolder::Find({.dataset = "procthor-10k"}, "");
  EXPECT_EQ(folder.path(), Fixtures() + "/scenes/procthor-10k-train");
  EXPECT_EQ(folder.size(), 4);
  EXPECT_EQ(folder.houses().size(), 2U);
  EXPECT_EQ(folder.houses().at(0).model.filename(), "train_0_ceiling.xml");
  EXPECT_EQ(folder.houses().at(0).map.filename(), "train_0_map.png");
  EXPECT_EQ(folder.houses().at(3).model.filename(), "train_3.xml");
  EXPECT_TRUE(folder.houses().at(3).metadata.empty());
  ExpectThrow<NotFoundError>([] { HouseFolder::Find({.dataset = "ithor"}, ""); },
                             "Folders there: procthor-10k-train");
}

TEST(HouseFolder, SplitsChooseAmongSeries) {
  const TempDir temp;
  for (const char* name : {"train_1.xml", "val_2.xml", "val_7.xml", "notes.xml"})
    Touch(temp / name);
  const auto find = [&](std::optional<std::string> split) {
    return HouseFolder::Find({.root = temp.path().string(), .split = std::move(split)}, "");
  };
  EXPECT_EQ(find({}).size(), 2);
  EXPECT_EQ(find("val").size(), 8);
  ExpectThrow<NotFoundError>([&] { find("test"); }, "no houses of split 'test'; it has train_");
}

TEST(HouseFolder, NamesOfIthorAreHouses) {
  const TempDir temp;
  Touch(temp / "ithor/FloorPlan12_physics.xml");
  Touch(temp / "ithor/FloorPlan12_metadata.json");
  const HouseFolder folder =
      HouseFolder::Find({.dataset = "ithor", .root = temp.path().string()}, "");
  EXPECT_EQ(folder.houses().at(12).metadata.filename(), "FloorPlan12_metadata.json");
}

TEST(HouseFolder, OneFileOfSeveralWithANumberIsChosenByName) {
  const TempDir temp;
  for (const char* name : {"FloorPlan1_physics.xml", "FloorPlan1.xml", "FloorPlan02.xml",
                           "FloorPlan2.xml", "FloorPlan3.xml"})
    Touch(temp / name);
  const HouseFolder folder = HouseFolder::Find({.root = temp.path().string()}, "");
  EXPECT_EQ(folder.houses().size(), 3U);
  EXPECT_EQ(folder.houses().at(1).model.filename(), "FloorPlan1_physics.xml");
  EXPECT_EQ(folder.houses().at(2).model.filename(), "FloorPlan02.xml");
  EXPECT_EQ(folder.notes(), (std::vector<std::string>{
                                "'FloorPlan1.xml' is not used: house 1 is 'FloorPlan1_physics.xml'",
                                "'FloorPlan2.xml' is not used: house 2 is 'FloorPlan02.xml'"}));
}

TEST(HouseFolder, BlacklistsHaveHousesAndObjects) {
  const TempDir temp;
  Touch(temp / "train_1.xml");
  AtomicWrite(temp / "list.txt", "1 # falls\n\ntrain_5\nBowl_1\nval_3.xml\n");
  const HouseFolder folder = HouseFolder::Find(
      {.root = ".", .without = {{"Mug_2"}}, .blacklist = "list.txt"}, temp.path().string());
  EXPECT_TRUE(folder.IsBlacklisted(1));
  EXPECT_TRUE(folder.IsBlacklisted(5));
  EXPECT_TRUE(folder.IsBlacklisted(3));
  EXPECT_FALSE(folder.IsBlacklisted(2));
  EXPECT_EQ(folder.without(), (std::vector<std::string>{"Mug_2", "Bowl_1"}));
}

}  // namespace
}  // namespace robocell::internal
