#include "robocell/rollout/dataset_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/prepare.h"
#include "robocell/rollout/run_env.h"
#include "robocell/rollout/runner.h"
#include "robocell/rollout/testing/demo.h"
#include "robocell/scene/scene.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(NumbersOfId, AreThoseOfThePlan) {
  EXPECT_EQ(NumbersOfId("s0003_e0012"), (PlanNumbers{.scene = 3, .episode = 12}));
  EXPECT_EQ(NumbersOfId("s0003_e0012_a02"), (PlanNumbers{.scene = 3, .episode = 12}));
  for (const char* other : {"", "s", "s3", "s3_", "s3e4", "sx_e1", "s1_ex", "episode_3", "s-1_e2",
                            "s99999999999999999999_e1"})
    EXPECT_EQ(NumbersOfId(other), std::nullopt) << other;
}

TEST(RunOfDataset, IsTheRunThatMadeIt) {
  const TempDir temp;
  RunConfig run = Demo();
  run.cameras.streams = {};
  fs::copy(fs::path(SourceDir()) / "models/scenes/tabletop.xml", temp / "table.xml");
  run.scenes = FilesScenes{.files = {(temp / "table.xml").string()}};
  run.output = (temp / "out").string();
  run.noise.emplace().translation = 0.001;
  PrepareDataset(run);
  ASSERT_TRUE(Runner(run).Run(MakePlan(run)[0]).success);
  fs::remove(temp / "table.xml");

  const RunConfig again = RunOfDataset(Dataset(run.output));
  EXPECT_EQ(again.run, run.run);
  EXPECT_EQ(again.task, run.task);
  EXPECT_EQ(again.seed, run.seed);
  EXPECT_EQ(again.output, "");
  EXPECT_FALSE(again.noise.has_value()) << "policies act without it";
  EXPECT_THAT(again.scenes.houses.values, ElementsAre(0));
  EXPECT_TRUE(fs::exists(again.scenes.As<FilesScenes>().files.at(0))) << "as the dataset keeps it";
  ExpectThrow<SpecError>([&] { Runner{again}; }, "output");
  EXPECT_NO_THROW(RunEnv{again});
}

TEST(RunOfDataset, NeedsAnEpisodeOfARun) {
  const TempDir temp;
  const RunConfig run = [&] {
    RunConfig demo = Demo();
    demo.output = (temp / "empty").string();
    return demo;
  }();
  PrepareDataset(run);
  ExpectThrow<ArgumentError>([&] { RunOfDataset(Dataset(run.output)); },
                             "has no episode, so its cell is unknown");
  fs::create_directory(temp / "others");
  SampleEpisode(0, false).Write(temp / "others", "e0");
  ExpectThrow<ArgumentError>(
      [&] { RunOfDataset(Dataset(temp / "others")); },
      "was recorded row by row (EpisodeWriter, `robocell import`), not made by a run");
}

TEST(HousesOfDataset, AreThoseOfTheReportAndOfItsEpisodes) {
  const TempDir temp;
  SampleEpisode(0, false).Write(temp.path(), "s0002_e0000");
  SampleEpisode(1, false).Write(temp.path(), "s0001_e0000");
  const Dataset dataset(temp.path());
  EXPECT_THAT(HousesOfDataset(dataset), ElementsAre(1, 2));
  const auto report = [&](const std::string& houses) {
    AtomicWrite(
        temp / "report.json",
        InsertSelfHash("{\"commands\": [{\"finished\": \"2026-01-01T00:00:00Z\"}], "
                       "\"houses\": " +
                       houses + ", \"json_sha256\": \"" + std::string(kHashPlaceholder) + "\"}"));
  };
  report("[5, 2]");
  EXPECT_THAT(HousesOfDataset(dataset), ElementsAre(5, 2, 1));
  report("[]");
  EXPECT_THAT(HousesOfDataset(dataset), IsEmpty()) << "all scenes of the source";
  report("null");
  EXPECT_THAT(HousesOfDataset(dataset), ElementsAre(1, 2)) << "an older report does not say";
}

}  // namespace
}  // namespace robocell
