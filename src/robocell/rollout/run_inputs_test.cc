#include "robocell/rollout/run_inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/files.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Key;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

RunConfig DemoRun() { return RunConfig::Load(SourceDir() + "/examples/demo.yaml"); }

TEST(RunInputs, AreTheModelsOfRobotSceneAndObjects) {
  RunConfig run = DemoRun();
  const RunInputs all = InputsOf(run);
  EXPECT_THAT(all.files, Contains(Key("rc7/rc7.xml")));
  EXPECT_THAT(all.files, Contains(Key("scenes/tabletop.xml")));
  EXPECT_THAT(all.files, Contains(Key("mug/mug.xml")));
  run.task.As<PickTaskConfig>().objects.names = {"box"};
  EXPECT_THAT(InputsOf(run).files, Not(Contains(Key("mug/mug.xml"))));
  EXPECT_THAT(all.versions, UnorderedElementsAre(Key("robocell"), Key("mujoco")));
  EXPECT_THAT(Differences(all, InputsOf(DemoRun())), IsEmpty());
}

TEST(RunInputs, AreTheSameForOtherWorkersOutputsAndMoreEpisodes) {
  RunConfig run = DemoRun();
  const RunInputs before = InputsOf(run);
  run.workers = 7;
  run.output = "elsewhere";
  run.episodes_per_scene = 1000;
  run.episodes = 3;
  EXPECT_THAT(Differences(before, InputsOf(run)), IsEmpty());
}

TEST(RunInputs, ADifferentFieldIsToldByItsPathWithBothValues) {
  RunConfig run = DemoRun();
  const RunInputs before = InputsOf(run);
  run.start.base_distance = {0.2, 0.5};
  run.seed = 7;
  run.cameras.streams[0].name = "hand";
  run.robot.config.stiffness = 20;
  EXPECT_THAT(Differences(before, InputsOf(run)),
              ElementsAre("cameras.streams[0].name: wrist then, hand now",
                          "robot.stiffness: not set then, 20 now", "seed: 0 then, 7 now",
                          "start.base_distance: [0.3, 0.55] then, [0.2, 0.5] now"));
}

TEST(RunInputs, AChangedMeshAndANewVersionAreNamed) {
  TempDir temp;
  fs::create_directory(temp / "rc7");
  RunConfig run = DemoRun();
  fs::copy(fs::path(SourceDir()) / "models/robots/rc7", temp / "rc7", fs::copy_options::recursive);
  run.robot.config.source_dir = (temp / "rc7").string();
  RunInputs before = InputsOf(run);
  const fs::path model = temp / "rc7/rc7.xml";
  AtomicWrite(model, ReadFile(model) + "<!-- another -->\n");
  EXPECT_THAT(Differences(before, InputsOf(run)),
              ElementsAre("model file rc7/rc7.xml: changed since then"));
  before = InputsOf(run);
  before.versions["mujoco"] = "3.9.0";
  before.files.erase("rc7/rc7.xml");
  before.files["rc7/old.stl"] = "0";
  EXPECT_THAT(
      Differences(before, InputsOf(run)),
      ElementsAre("mujoco: 3.9.0 then, 4.0.0 now", "model file rc7/old.stl: no longer used or gone",
                  "model file rc7/rc7.xml: new since then"));
}

// Where a dataset with its run and models lies is no part of what it is.
TEST(RunInputs, AreTheSameInAFolderOfAnotherName) {
  TempDir temp;
  RunConfig run = DemoRun();
  fs::copy(fs::path(SourceDir()) / "models/robots/rc7", temp / "cell");
  run.robot.config.source_dir = (temp / "cell").string();
  const RunInputs before = InputsOf(run);
  EXPECT_THAT(before.files, Contains(Key("cell/rc7.xml")));
  fs::rename(temp / "cell", temp / "moved");
  run.robot.config.source_dir = (temp / "moved").string();
  EXPECT_THAT(InputsOf(run).files, Contains(Key("moved/rc7.xml")));
  EXPECT_THAT(Differences(before, InputsOf(run)), IsEmpty());
  AtomicWrite(temp / "moved/rc7.xml", ReadFile(temp / "moved/rc7.xml") + "<!-- another -->\n");
  EXPECT_THAT(Differences(before, InputsOf(run)),
              ElementsAre("model file cell/rc7.xml: no longer used or gone",
                          "model file moved/rc7.xml: new since then"));
}

// The same bytes, and yet other meshes.
TEST(RunInputs, SwappedFilesAreDifferent) {
  RunInputs then{.identity = "", .versions = {}, .files = {{"a/x.stl", "1"}, {"a/y.stl", "2"}}};
  RunInputs now{.identity = "", .versions = {}, .files = {{"b/x.stl", "2"}, {"b/y.stl", "1"}}};
  EXPECT_EQ(Differences(then, now).size(), 4u);
  now.files = {{"b/x.stl", "1"}, {"b/y.stl", "2"}};
  EXPECT_THAT(Differences(then, now), IsEmpty());
  then.files = {{"a/x.stl", "1"}, {"c/x.stl", "1"}};
  now.files = {{"b/x.stl", "1"}};
  EXPECT_THAT(Differences(then, now), ElementsAre("model file a/x.stl: no longer used or gone"));
}

TEST(RunInputs, ModelsOfTheSameNameInFoldersOfTheSameNameAreTwo) {
  TempDir temp;
  RunConfig run = DemoRun();
  const std::string table = ReadFile(fs::path(SourceDir()) / "models/scenes/tabletop.xml");
  FilesScenes scenes;
  for (const char* folder : {"a/room", "b/room"}) {
    fs::create_directories(temp / folder);
    AtomicWrite(temp / folder / "table.xml", table);
    scenes.files.push_back((temp / folder / "table.xml").string());
  }
  run.scenes = scenes;
  const RunInputs before = InputsOf(run);
  EXPECT_THAT(before.files, Contains(Key("room/table.xml")));
  EXPECT_THAT(before.files, Contains(Key("room/table.xml (2)")));
  AtomicWrite(temp / "a/room/table.xml", table + "<!-- another -->\n");
  EXPECT_THAT(Differences(before, InputsOf(run)),
              ElementsAre("model file room/table.xml: changed since then"));
  AtomicWrite(temp / "a/room/table.xml", table);
  AtomicWrite(temp / "b/room/table.xml", table + "<!-- another -->\n");
  EXPECT_THAT(Differences(before, InputsOf(run)),
              ElementsAre("model file room/table.xml (2): changed since then"));
}

}  // namespace
}  // namespace robocell
