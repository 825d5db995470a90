#include "robocell/rollout/source_demos.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/data/dataset.h"
#include "robocell/data/episode_writer.h"
#include "robocell/rollout/dataset_run.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/prepare.h"
#include "robocell/rollout/replay.h"
#include "robocell/rollout/run_inputs.h"
#include "robocell/rollout/runner.h"
#include "robocell/rollout/testing/demo.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;

RunConfig PicksOfBoxes(const std::filesystem::path& output, int64_t seed) {
  RunConfig run = Demo();
  run.cameras.streams = {};
  run.task.If<PickTaskConfig>()->objects = {"box"};
  run.output = output.string();
  run.seed = seed;
  run.episodes = 2;
  return run;
}

// One dataset of two picks for all tests, and one that repeats them from other starts.
class SourceDemosTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempDir();
    Make(PicksOfBoxes(*folder_ / "source", 1));
    RunConfig run = PicksOfBoxes(*folder_ / "augmented", 2);
    run.augment.emplace().dataset = (*folder_ / "source").string();
    results_ = new std::vector<ItemResult>(Make(run));
  }
  static void TearDownTestSuite() {
    delete results_;
    delete folder_;
  }
  static std::vector<ItemResult> Make(const RunConfig& run) {
    PrepareDataset(run);
    Runner runner(run);
    std::vector<ItemResult> results;
    for (const PlanItem& item : MakePlan(run)) results.push_back(runner.Run(item));
    return results;
  }
  RunConfig Augmenting() const {
    RunConfig run = PicksOfBoxes(*folder_ / "augmented", 2);
    run.augment.emplace().dataset = (*folder_ / "source").string();
    return run;
  }

  static TempDir* folder_;
  static std::vector<ItemResult>* results_;
};
TempDir* SourceDemosTest::folder_ = nullptr;
std::vector<ItemResult>* SourceDemosTest::results_ = nullptr;

TEST_F(SourceDemosTest, ReadsThePartsOfAnEpisode) {
  const Dataset source(*folder_ / "source");
  const Demonstration demo = ReadDemonstration(source.At(0), "rc7");
  EXPECT_EQ(demo.rows(), source.At(0).rows());
  EXPECT_EQ(demo.object_kind, "box");
  EXPECT_DOUBLE_EQ(demo.tick, 0.066);
  EXPECT_TRUE(HasSegmentLabels(demo));
  ASSERT_EQ(demo.segments.size(), 1U);
  EXPECT_EQ(demo.segments[0].reference, "target");
}

TEST_F(SourceDemosTest, EpisodesAreMovedToNewStartsAndSayFromWhere) {
  const Dataset source(*folder_ / "source"), augmented(*folder_ / "augmented");
  ASSERT_EQ(augmented.size(), 2U);
  for (const Episode& episode : augmented) {
    EXPECT_TRUE(episode.success());
    const auto results = nlohmann::json::parse(episode.results_json());
    EXPECT_THAT(source.ids(), Contains(results["augmented"]["source"].get<std::string>()));
    EXPECT_EQ(results["augmented"]["segments_from"], "labels");
    EXPECT_EQ(results["augmented"]["segments"][0]["reference"], "target");
    EXPECT_EQ(episode.column("phase").spec.values.front(), "move");
    EXPECT_TRUE(VerifyReplay(episode).ok());
    // It is another start, and the grasp is the same at the object.
    const Demonstration made = ReadDemonstration(episode, "rc7");
    const Demonstration from =
        ReadDemonstration(source.Open(results["augmented"]["source"].get<std::string>()), "rc7");
    const auto grasp = [](const Demonstration& demo) {
      const DemoSegment& segment = demo.segments.at(0);
      return demo.bodies.at("target")[static_cast<size_t>(segment.first)].inverse() *
             demo.target_in_world[static_cast<size_t>(segment.end) - 1];
    };
    EXPECT_FALSE(made.bodies.at("target")[0].is_close(from.bodies.at("target")[0], 0.01, 0.001));
    EXPECT_TRUE(grasp(made).is_close(grasp(from), 0.05, 0.01));
  }
}

TEST_F(SourceDemosTest, TheSourcesContentBelongsToTheRunAndItsPathDoesNot) {
  const RunConfig run = Augmenting();
  EXPECT_NO_THROW(RequireSameRun(run));
  RunConfig moved = run;
  std::filesystem::copy(*folder_ / "source", *folder_ / "moved",
                        std::filesystem::copy_options::recursive);
  moved.augment->dataset = (*folder_ / "moved").string();
  EXPECT_EQ(RunIdentity(moved), RunIdentity(run));
  EXPECT_NO_THROW(RequireSameRun(moved));
  // A source less, and no source at all.
  moved.augment->episodes = {Dataset(moved.augment->dataset).ids().front()};
  ExpectThrow<SpecError>([&] { RequireSameRun(moved); }, "augment.episodes");
  moved.augment.reset();
  ExpectThrow<SpecError>([&] { RequireSameRun(moved); }, "source episode s0000_e0001");
  // Whoever goes on with the cell of an augmented dataset does not need its sources.
  EXPECT_FALSE(RunOfDataset(Dataset(run.output)).augment.has_value());
}

TEST_F(SourceDemosTest, SaysWhatASourceLacks) {
  const auto write = [&](const std::string& name, const std::vector<std::string>& poses) {
    EpisodeSchema schema;
    const ColumnId time = schema.AddColumn({.name = "time", .units = "s"});
    std::vector<ColumnId> columns;
    for (const std::string& pose : poses)
      columns.push_back(schema.AddColumn({.name = pose, .shape = {7}, .units = "m, 1"}));
    std::filesystem::create_directories(*folder_ / name);
    EpisodeWriter writer(*folder_ / name, "e", schema, {.metadata_json = "{}"});
    for (int row = 0; row < 3; ++row) {
      writer.Put(time, 0.1 * row);
      for (const ColumnId& column : columns) {
        const double pose[7] = {0.01 * row, 0, 0, 0, 0, 0, 1};
        writer.Put(column, std::span<const double>(pose));
      }
      writer.EndRow();
    }
    writer.Commit({.success = true});
    return Episode(*folder_ / name / "e");
  };
  ExpectThrow<ArgumentError>([&] { ReadDemonstration(write("nothing", {}), "arm"); },
                             "has no column robots/arm/tcp_pose");
  ExpectThrow<ArgumentError>(
      [&] { ReadDemonstration(write("no_object", {"robots/arm/tcp_pose"}), "arm"); },
      "objects/<object>/pose");
  // Recorded elsewhere, and without commands: the targets are where the hand went.
  const Demonstration demo =
      ReadDemonstration(write("all", {"robots/arm/tcp_pose", "objects/cup/pose"}), "other");
  EXPECT_DOUBLE_EQ(demo.tick, 0.1);
  EXPECT_EQ(demo.target_in_world[0], demo.tcp_in_world[1]);
  EXPECT_EQ(demo.target_in_world[2], demo.tcp_in_world[2]);
}

}  // namespace
}  // namespace robocell::internal
