#include "robocell/rollout/run_inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/dataset.h"
#include "robocell/data/verify.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/rollout/on_disk.h"
#include "robocell/rollout/prepare.h"
#include "robocell/rollout/runner.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/scoped_env.h"
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

TEST(RunInputs, AnnotationsOfScenesCount) {
  const TempDir temp;
  fs::create_directory(temp / "lab");
  AtomicWrite(temp / "lab/lab.xml",
              "<mujoco><worldbody><geom type='box' size='1 1 .3'/></worldbody></mujoco>");
  RunConfig run = DemoRun();
  run.scenes = FilesScenes{.files = {"lab.xml"}, .root = (temp / "lab").string()};
  const RunInputs before = InputsOf(run);
  AtomicWrite(temp / "lab/lab.annotations.yaml", "rooms: [{name: lab}]\n");
  const RunInputs after = InputsOf(run);
  EXPECT_THAT(before.files, Not(Contains(Key("lab/lab.annotations.yaml"))));
  EXPECT_THAT(after.files, Contains(Key("lab/lab.annotations.yaml")));
  AtomicWrite(temp / "lab/lab.annotations.yaml", "rooms: [{name: shop}]\n");
  EXPECT_THAT(Differences(after, InputsOf(run)), Not(IsEmpty()));

  run.scenes = SceneSourceSpec("houses");
  run.scenes.houses.values = {0};
  fs::create_directory(temp / "cache");
  const ScopedEnv cache("ROBOCELL_CACHE_DIR", (temp / "cache").string());
  int count = 0;
  for (const auto& [name, hash] : InputsOf(run).files)
    count += name.ends_with("_map.png") || name.ends_with("_metadata.json");
  EXPECT_EQ(count, 2);
}

TEST(RunInputs, ImagesThatLooksAreDrawnFromCount) {
  const TempDir temp;
  fs::create_directory(temp / "planks");
  AtomicWrite(temp / "planks/oak.png", "oak");
  RunConfig run = DemoRun();
  const RunInputs without = InputsOf(run);
  run.randomize.emplace().appearance["table"].texture = {(temp / "planks/").string(), "wood"};
  run.randomize->pinned["rc7/texture"].word = (temp / "pin.png").string();
  AtomicWrite(temp / "pin.png", "pin");
  const RunInputs before = InputsOf(run);
  EXPECT_EQ(before.files.size(), without.files.size() + 3) << "with the model of the studio";
  EXPECT_THAT(before.files, Contains(Key("texture/planks/oak.png")));
  const RunFilesWatch watch(before);
  EXPECT_NO_THROW(watch.RequireUnchanged(run));
  AtomicWrite(temp / "planks/fir.png", "fir");
  EXPECT_THAT(LinesOf(Differences(before, InputsOf(run))),
              ElementsAre("texture file planks/fir.png: new since then"));
  ExpectThrow<IoError>([&] { watch.RequireUnchanged(run); }, "fir.png");
  fs::remove(temp / "planks/fir.png");
  AtomicWrite(temp / "planks/oak.png", "elm");
  EXPECT_THAT(LinesOf(Differences(before, InputsOf(run))),
              ElementsAre("texture file planks/oak.png: changed since then"));
  ExpectThrow<IoError>([&] { watch.RequireUnchanged(run); }, "oak.png");
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

TEST(RunInputs, ReportsADifferentFieldWithItsPathAndBothValues) {
  RunConfig run = DemoRun();
  const RunInputs before = InputsOf(run);
  run.start.base_distance = {0.2, 0.5};
  run.seed = 7;
  run.cameras.streams[0].name = "hand";
  run.robot.config.stiffness = 20;
  EXPECT_THAT(LinesOf(Differences(before, InputsOf(run))),
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
  EXPECT_THAT(LinesOf(Differences(before, InputsOf(run))),
              ElementsAre("model file rc7/rc7.xml: changed since then"));
  before = InputsOf(run);
  before.versions["mujoco"] = "3.9.0";
  before.files.erase("rc7/rc7.xml");
  before.files["rc7/old.stl"] = "0";
  EXPECT_THAT(
      LinesOf(Differences(before, InputsOf(run))),
      ElementsAre("mujoco: 3.9.0 then, 4.0.0 now", "model file rc7/old.stl: no longer used or gone",
                  "model file rc7/rc7.xml: new since then"));
}

// The path of a dataset with its run and models does not belong to its inputs.
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
  EXPECT_THAT(LinesOf(Differences(before, InputsOf(run))),
              ElementsAre("model file cell/rc7.xml: no longer used or gone",
                          "model file moved/rc7.xml: new since then"));
}

// The bytes are the same, but the meshes have swapped places.
TEST(RunInputs, SwappedFilesAreDifferent) {
  RunInputs then{.identity = "", .versions = {}, .files = {{"a/x.stl", "1"}, {"a/y.stl", "2"}}};
  RunInputs now{.identity = "", .versions = {}, .files = {{"b/x.stl", "2"}, {"b/y.stl", "1"}}};
  EXPECT_EQ(Differences(then, now).size(), 4u);
  now.files = {{"b/x.stl", "1"}, {"b/y.stl", "2"}};
  EXPECT_THAT(Differences(then, now), IsEmpty());
  then.files = {{"a/x.stl", "1"}, {"c/x.stl", "1"}};
  now.files = {{"b/x.stl", "1"}};
  EXPECT_THAT(LinesOf(Differences(then, now)),
              ElementsAre("model file a/x.stl: no longer used or gone"));
}

TEST(RunInputs, DistinguishModelsWithEqualNamesAndFolders) {
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
  EXPECT_THAT(LinesOf(Differences(before, InputsOf(run))),
              ElementsAre("model file room/table.xml: changed since then"));
  AtomicWrite(temp / "a/room/table.xml", table);
  AtomicWrite(temp / "b/room/table.xml", table + "<!-- another -->\n");
  EXPECT_THAT(LinesOf(Differences(before, InputsOf(run))),
              ElementsAre("model file room/table.xml (2): changed since then"));
}

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A run with a user's own robot: a copy that a test may edit or move, with the dataset beside it.
class RunFilesWatchTest : public ::testing::Test {
 protected:
  RunFilesWatchTest() : run_(OwnRun(temp_ / "cell")) {}

  static RunConfig OwnRun(const fs::path& folder) {
    if (!fs::exists(folder)) fs::copy(fs::path(SourceDir()) / "models/robots/rc7", folder);
    RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
    run.cameras.streams = {};
    run.robot.config.source_dir = folder.string();
    run.output = (folder / "out").string();
    PrepareDataset(run, {.validate = false});
    return run;
  }
  fs::path model() const { return temp_ / "cell/rc7.xml"; }
  void Edit() const { AtomicWrite(model(), original_ + "<!-- another -->\n"); }
  void PutBack() const { AtomicWrite(model(), original_); }

  TempDir temp_;
  RunConfig run_;
  std::string original_ = ReadFile(temp_ / "cell/rc7.xml");
};

TEST_F(RunFilesWatchTest, AChangedOrRemovedFileIsNamedWithTheNextStep) {
  const RunFilesWatch watch(RequireSameRun(run_));
  EXPECT_NO_THROW(watch.RequireUnchanged(run_));
  Edit();
  EXPECT_EQ(ExpectThrow<IoError>([&] { watch.RequireUnchanged(run_); }, "rc7.xml"),
            "run 'demo': '" + model().string() + "' changed during the run into the dataset '" +
                run_.output +
                "': episodes made with it are discarded. Restore it and repeat the command, or "
                "give another `output` to start a new dataset");
  fs::remove(model());
  ExpectThrow<IoError>([&] { watch.RequireUnchanged(run_); }, model().string());
  PutBack();
  EXPECT_NO_THROW(watch.RequireUnchanged(run_)) << "what it holds counts, not when it was written";
}

// At any time: before an item, while its start is sampled and compiled, and while the expert acts.
TEST_F(RunFilesWatchTest, ARunnerDiscardsEpisodesOfAChangedModel) {
  const std::vector<PlanItem> plan = MakePlan(run_);
  bool edits = false;
  Runner runner(run_, {.sampler = {}, .expert = [&](const RunConfig& run, const EpisodeStart& at) {
                         if (edits) Edit();
                         return MakePickPlanner(run, at);
                       }});
  EXPECT_TRUE(runner.Run(plan[0]).success);
  edits = true;
  ExpectThrow<IoError>([&] { runner.Run(plan[1]); }, "changed during the run into the dataset");
  edits = false;
  EXPECT_THAT(LookForItems(run_, plan).made, ElementsAre(plan[0].id)) << "made before";
  ExpectThrow<IoError>([&] { runner.Run(plan[1]); }, "changed during the run into the dataset");
  ExpectThrow<SpecError>([&] { Runner(run_).Run(plan[1]); },
                         "model file cell/rc7.xml: changed since then");
  EXPECT_THAT(Dataset(run_.output).ids(), ElementsAre(plan[0].id));
  PutBack();
  EXPECT_TRUE(runner.Run(plan[1]).success);
  EXPECT_TRUE(Verify(run_.output).ok());
}

// The dataset as earlier versions wrote it.
TEST_F(RunFilesWatchTest, VerifyNamesEpisodesOfAModelThatChanged) {
  const std::vector<PlanItem> plan = MakePlan(run_);
  Runner(run_).Run(plan[0]);
  const std::string manifest = *ReadManifest(run_.output);
  Edit();
  auto other = nlohmann::json::parse(manifest);
  other["files"] = InputsOf(run_).files;
  WriteManifest(run_.output, other.dump());
  Runner(run_).Run(plan[1]);
  WriteManifest(run_.output, manifest);
  const VerifyResult result = Verify(run_.output);
  EXPECT_THAT(result.good, ElementsAre(plan[0].id));
  EXPECT_THAT(result.bad, ElementsAre(plan[1].id));
  EXPECT_THAT(result.Text(), HasSubstr(plan[1].id + ": it was made with another 'rc7.xml' (models/"
                                                    "rc7-"));
  EXPECT_THAT(result.Text(), HasSubstr("than the one that dataset.json lists: the file was changed "
                                       "while the run went on, or the episode was copied from "
                                       "another dataset. `robocell verify --repair` sets it "
                                       "aside, `robocell generate` makes it again"));
  EXPECT_THAT(Repair(run_.output).moved, ElementsAre(plan[1].id));
  PutBack();
  EXPECT_TRUE(Runner(run_).Run(plan[1]).success);
  EXPECT_TRUE(Verify(run_.output).ok());
}

// With and without the dataset's copy of its model.
TEST_F(RunFilesWatchTest, IgnoresAnEpisodeCopiedFromARunWithAnotherModel) {
  const std::vector<PlanItem> plan = MakePlan(run_);
  Runner(run_).Run(plan[0]);
  fs::create_directory(temp_ / "other");
  for (const char* file : {"rc7.xml", "rc7.yaml"})
    fs::copy(temp_ / "cell" / file, temp_ / "other" / file);
  AtomicWrite(temp_ / "other/rc7.xml", original_ + "<!-- another -->\n");
  const RunConfig other = OwnRun(temp_ / "other");
  Runner(other).Run(plan[1]);
  const fs::path here = run_.output, there = other.output;
  fs::copy(there / plan[1].id, here / plan[1].id);
  for (const bool with_model : {false, true}) {
    if (with_model)
      fs::copy(there / "models", here / "models",
               fs::copy_options::recursive | fs::copy_options::skip_existing);
    const PlanOnDisk found = LookForItems(run_, plan);
    EXPECT_THAT(found.made, ElementsAre(plan[0].id));
    EXPECT_THAT(found.broken, ElementsAre("'" + (here / plan[1].id).string() +
                                          "' is an episode of another run (model file rc7.xml: "
                                          "changed since then): move it away yourself"));
  }
  EXPECT_THAT(Verify(here).bad, ElementsAre(plan[1].id)) << "it says the same";
  fs::remove(here / "dataset.json");
  ExpectThrow<SpecError>([&] { PrepareDataset(run_, {.validate = false}); },
                         "model file rc7.xml: changed since then");
}

nlohmann::json WithoutRun(const fs::path& episode) {
  auto description = nlohmann::json::parse(ReadFile(episode / "episode.json"));
  description.erase("run");
  return description;
}

TEST_F(RunFilesWatchTest, AMovedFolderContinuesWithTheSameBytes) {
  const std::vector<PlanItem> plan = MakePlan(run_);
  Runner(run_).Run(plan[0]);
  fs::copy(temp_ / "cell", temp_ / "moved", fs::copy_options::recursive);
  const RunConfig moved = OwnRun(temp_ / "moved");
  EXPECT_TRUE(Runner(moved).Run(plan[0]).resumed);
  for (const RunConfig& run : {run_, moved}) EXPECT_EQ(Runner(run).Run(plan[1]).kept, 1);
  for (const PlanItem& item : {plan[0], plan[1]}) {
    const fs::path here = fs::path(run_.output) / item.id, there = fs::path(moved.output) / item.id;
    EXPECT_EQ(ReadFile(here / "steps.h5"), ReadFile(there / "steps.h5"));
    EXPECT_EQ(WithoutRun(here), WithoutRun(there));
  }
  EXPECT_EQ(ReadManifest(run_.output), ReadManifest(moved.output));
  EXPECT_TRUE(Verify(moved.output).ok());
}

}  // namespace
}  // namespace robocell
