#include "robocell/scenes/houses/prepared_house.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mjmodel.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/files.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(PreparedHouse, BalancesInertiasInACopy) {
  const TempDir cache;
  const ScopedEnv env("ROBOCELL_CACHE_DIR", cache.path().string());
  const HouseFolder folder =
      HouseFolder::Find({.root = SourceDir() + "/tests/houses/scenes/procthor-10k-train"}, "");
  const PreparedHouse whole = PrepareHouse(folder.houses().at(0), folder);
  EXPECT_EQ(whole.why_not, "");
  EXPECT_EQ(whole.model, folder.houses().at(0).model);
  const PreparedHouse mended = PrepareHouse(folder.houses().at(3), folder);
  EXPECT_EQ(mended.why_not, "");
  EXPECT_THAT(mended.notes, ElementsAre(HasSubstr("2 bodies were balanced: Statue|0|2, Cup|0|3")));
  EXPECT_THAT(mended.model.string(), HasSubstr(cache.path().string()));
  Scene::Build({.base = mended.model.string(), .timestep = 0.002});
}

constexpr const char* kFloor = R"(<geom type="plane" size="5 5 0.1"/>)";

// The bodies of house 0 in a folder.
std::vector<std::string> BodiesOf(const std::filesystem::path& folder,
                                  std::vector<std::string> without) {
  const HouseFolder house =
      HouseFolder::Find({.root = folder.string(), .without = {std::move(without)}}, "");
  const PreparedHouse prepared = PrepareHouse(house.houses().at(0), house);
  EXPECT_EQ(prepared.why_not, "");
  const Scene scene = Scene::Build({.base = prepared.model.string(), .timestep = 0.002});
  std::vector<std::string> names = ElementNames(scene.model(), mjOBJ_BODY);
  names.erase(names.begin());  // the world
  return names;
}

// A house with the objects a ... e; "e" is in a file of its own.
struct FiveObjects {
  TempDir folder, cache;
  ScopedEnv env{"ROBOCELL_CACHE_DIR", cache.path().string()};

  FiveObjects() {
    WriteHouse();
    WriteLast("e");
  }
  void WriteHouse() {
    std::string bodies = kFloor;
    for (const char* name : {"a", "b", "c", "d"})
      bodies += fmt::format(R"(<body name="{}"><geom size="0.1"/></body>)", name);
    AtomicWrite(folder / "train_0.xml",
                "<mujoco><worldbody>" + bodies + R"(<include file="e.xml"/></worldbody></mujoco>)");
  }
  void WriteLast(const std::string& name) {
    AtomicWrite(folder / "e.xml",
                fmt::format(R"(<mujoco><body name="{}"><geom size="0.1"/></body></mujoco>)", name));
  }
  std::vector<std::string> Left(std::vector<std::string> without) const {
    return BodiesOf(folder.path(), std::move(without));
  }
};

TEST(PreparedHouse, EveryListOfObjectsLeftOutHasItsOwnCopy) {
  FiveObjects house;
  // Notes name three objects of four, the same ones in both.
  EXPECT_THAT(house.Left({"a", "b", "c", "d"}), ElementsAre("e"));
  EXPECT_THAT(house.Left({"a", "b", "c", "e"}), ElementsAre("d"));
  EXPECT_THAT(house.Left({"a", "b", "c", "d"}), ElementsAre("e"));
}

TEST(PreparedHouse, IsReadFromTheDiskWhileItsAssetsStay) {
  const TempDir set, first, second, third;
  fs::copy(SourceDir() + "/tests/houses/scenes/procthor-10k-train", set.path(),
           fs::copy_options::recursive);
  const HouseFolder folder = HouseFolder::Find({.root = set.path().string()}, "");
  const auto prepare = [&](const TempDir& cache) {
    const ScopedEnv env("ROBOCELL_CACHE_DIR", cache.path().string());
    return PrepareHouse(folder.houses().at(0), folder);
  };
  EXPECT_TRUE(prepare(first).notes.empty());
  // Another cache, with a note that tells it from one that was made anew.
  fs::copy(first / "houses", second / "houses", fs::copy_options::recursive);
  const fs::path verdict = fs::directory_iterator(second / "houses/prepared")->path();
  std::string text = ReadFile(verdict);
  const size_t at = text.find("\"notes\":[");
  ASSERT_NE(at, std::string::npos) << text;
  AtomicWrite(verdict, text.insert(at + 9, "\"from the disk\""));
  EXPECT_THAT(prepare(second).notes, ElementsAre("from the disk"));
  // In a third cache, after an asset has gone.
  fs::copy(second / "houses", third / "houses", fs::copy_options::recursive);
  fs::remove(set / "train_0_assets/Bowl_1.obj");
  EXPECT_THAT(prepare(third).why_not, HasSubstr("missing: Bowl_1.obj"));
}

TEST(PreparedHouse, EntriesAreWholeNamesOrHashesOfAssets) {
  const TempDir folder;
  const std::string hash = "0123456789abcdef0123456789abcdef";
  std::string bodies = kFloor;
  for (const std::string& name :
       {std::string("dining_table_1_0_2"), std::string("dining_table_1_0_21"), "mug_" + hash + "_1",
        "mug_" + hash + "0_1", "bowl_" + hash})
    bodies += fmt::format(R"(<body name="{}"><geom size="0.1"/></body>)", name);
  AtomicWrite(folder / "train_0.xml", "<mujoco><worldbody>" + bodies + "</worldbody></mujoco>");
  EXPECT_THAT(BodiesOf(folder.path(), {"dining_table_1_0_2", hash}),
              ElementsAre("dining_table_1_0_21", "mug_" + hash + "0_1"));
}

TEST(PreparedHouse, ChangedIncludesMakeANewCopy) {
  FiveObjects house;
  EXPECT_THAT(house.Left({"a", "b", "c"}), ElementsAre("d", "e"));
  house.WriteLast("f");
  house.WriteHouse();  // the same text; this process compares the main file only
  EXPECT_THAT(house.Left({"a", "b", "c"}), ElementsAre("d", "f"));
}

// Each process of a run would compile it again for every question.
TEST(PreparedHouse, OneThatDoesNotCompileIsRememberedUntilAFileChanges) {
  FiveObjects house;
  house.WriteLast("a");  // a name twice
  const HouseFolder folder = HouseFolder::Find({.root = house.folder.path().string()}, "");
  const auto why_not = [&] { return PrepareHouse(folder.houses().at(0), folder).why_not; };
  const std::string reason = why_not();
  EXPECT_THAT(reason, HasSubstr("repeated name 'a'"));
  const fs::path verdict = fs::directory_iterator(house.cache / "houses/prepared")->path();
  std::string text = ReadFile(verdict);
  const size_t at = text.find("repeated name");
  ASSERT_NE(at, std::string::npos) << text;
  AtomicWrite(verdict, text.insert(at, "from the disk: "));
  EXPECT_THAT(why_not(), HasSubstr("from the disk: "));
  house.WriteLast("e");
  EXPECT_EQ(why_not(), "");
}

TEST(PreparedHouse, OneWithoutAnyPlaceIsLeftOut) {
  const TempDir cache, houses;
  const ScopedEnv env("ROBOCELL_CACHE_DIR", cache.path().string());
  const std::string wall = R"(<geom type="box" size="3 0.05 1" pos="0 3 1"/>)";
  const std::string table =
      R"(<body name="table" pos="0 0 0.4"><geom type="box" size="0.4 0.4 0.4"/></body>)";
  const std::vector<std::string> contents = {"", wall, wall + kFloor, wall + table};
  for (size_t i = 0; i < contents.size(); ++i) {
    AtomicWrite(houses / fmt::format("train_{}.xml", i),
                "<mujoco><worldbody>" + contents[i] + "</worldbody></mujoco>");
  }
  const HouseFolder folder = HouseFolder::Find({.root = houses.path().string()}, "");
  for (const int index : {0, 1}) {
    EXPECT_EQ(PrepareHouse(folder.houses().at(index), folder).why_not,
              "it has neither a level face for objects nor a free floor");
  }
  for (const int index : {2, 3})
    EXPECT_EQ(PrepareHouse(folder.houses().at(index), folder).why_not, "") << index;
}

}  // namespace
}  // namespace robocell::internal
