#include "robocell/rollout/run_files_watch.h"

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
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A run whose robot is the user's own: a copy that a test may edit or move, with the dataset beside
// it.
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
            "run 'demo': '" + model().string() + "' changed while the dataset '" + run_.output +
                "' is being made: what was made with it is not kept. Put it back and give the same "
                "command again, or give another `output` to start a new dataset");
  fs::remove(model());
  ExpectThrow<IoError>([&] { watch.RequireUnchanged(run_); }, model().string());
  PutBack();
  EXPECT_NO_THROW(watch.RequireUnchanged(run_)) << "what it holds counts, not when it was written";
}

// At any time: before an item, while its start is sampled and compiled, and while it is acted.
TEST_F(RunFilesWatchTest, ARunnerKeepsNothingOfAModelThatChanged) {
  const std::vector<PlanItem> plan = MakePlan(run_);
  bool edits = false;
  Runner runner(run_, {.sampler = {}, .expert = [&](const RunConfig& run, const EpisodeStart& at) {
                         if (edits) Edit();
                         return MakePickPlanner(run, at);
                       }});
  EXPECT_TRUE(runner.Run(plan[0]).success);
  edits = true;
  ExpectThrow<IoError>([&] { runner.Run(plan[1]); }, "changed while the dataset");
  edits = false;
  EXPECT_THAT(LookForItems(run_, plan).made, ElementsAre(plan[0].id)) << "made before";
  ExpectThrow<IoError>([&] { runner.Run(plan[1]); }, "changed while the dataset");
  ExpectThrow<SpecError>([&] { Runner(run_).Run(plan[1]); },
                         "model file cell/rc7.xml: changed since then");
  EXPECT_THAT(Dataset(run_.output).ids(), ElementsAre(plan[0].id));
  PutBack();
  EXPECT_TRUE(runner.Run(plan[1]).success);
  EXPECT_TRUE(Verify(run_.output).ok());
}

// What earlier versions made of it.
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

// With what the dataset keeps of its model or without.
TEST_F(RunFilesWatchTest, AnEpisodeThatWasCopiedFromARunOfAnotherModelDoesNotCount) {
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

TEST_F(RunFilesWatchTest, AFolderThatWasMovedGoesOnWithTheSameBytes) {
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
