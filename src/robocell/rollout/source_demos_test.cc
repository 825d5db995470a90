#include "robocell/rollout/source_demos.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/data/dataset.h"
#include "robocell/data/episode_writer.h"
#include "robocell/rollout/dataset_run.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/prepare.h"
#include "robocell/rollout/randomized_record.h"
#include "robocell/rollout/replay.h"
#include "robocell/rollout/run_inputs.h"
#include "robocell/rollout/runner.h"
#include "robocell/rollout/testing/rollout_test_base.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;
using ::testing::SizeIs;

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
    results_ = new std::vector<ItemResult>(Make(Augmenting()));
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
  // Other masses, dampings and delays, and noise: none of them is in the source.
  static RunConfig Augmenting() {
    RunConfig run = PicksOfBoxes(*folder_ / "augmented", 2);
    run.augment.emplace().dataset = (*folder_ / "source").string();
    run.noise.emplace().translation = 0.001;
    run.randomize = FromYamlUnchecked<RandomizeConfig>(
        "dynamics: {objects: {mass: {scale: {uniform: [0.8, 1.2]}}},"
        " robots: {damping: {scale: {uniform: [0.8, 1.2]}}}}\n"
        "action_delay: {uniform: [0.01, 0.06]}");
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
    EXPECT_EQ(results["noise"]["actions"], episode.rows());
    EXPECT_FALSE(RandomizedOf(episode).empty());
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

// A column of poses of three rows; by default each is 1 cm further along x.
struct PoseColumn {
  std::string name;
  std::vector<double> xs = {0, 0.01, 0.02};
  int64_t size = 7;
};

Episode Write(const std::filesystem::path& folder, const std::vector<PoseColumn>& poses,
              const std::string& metadata = "{}") {
  EpisodeSchema schema;
  const ColumnId time = schema.AddColumn({.name = "time", .units = "s"});
  std::vector<ColumnId> columns;
  for (const PoseColumn& pose : poses)
    columns.push_back(schema.AddColumn({.name = pose.name, .shape = {pose.size}, .units = "m, 1"}));
  std::filesystem::create_directories(folder);
  EpisodeWriter writer(folder, "e", schema, {.metadata_json = metadata});
  for (size_t row = 0; row < 3; ++row) {
    writer.Put(time, 0.1 * static_cast<double>(row));
    for (size_t i = 0; i < poses.size(); ++i) {
      std::vector<double> pose(static_cast<size_t>(poses[i].size));
      pose[0] = poses[i].xs[row];
      pose[6] = 1;
      writer.Put(columns[i], std::span<const double>(pose));
    }
    writer.EndRow();
  }
  writer.Commit({.success = true});
  return Episode(folder / "e");
}

// What is logged while a source is read.
std::string LogOfReading(const Episode& episode, Demonstration& demo) {
  std::string log;
  const ScopedLogSink sink([&](LogLevel, std::string_view text) { log += text; });
  demo = ReadDemonstration(episode, "rc7");
  return log;
}

const std::string kTcp = "robots/rc7/tcp_pose", kCup = "objects/cup/pose";

TEST_F(SourceDemosTest, ColumnsThatAreNoPosesAreNamed) {
  const double nan = std::nan("");
  for (const int64_t size : {8, 14, 16}) {
    ExpectThrow<ArgumentError>(
        [&] {
          ReadDemonstration(Write(*folder_ / "sizes", {{kTcp, {0, 0, 0}, size}, {kCup}}), "");
        },
        "column " + kTcp + " has rows of shape");
    std::filesystem::remove_all(*folder_ / "sizes");
  }
  ExpectThrow<ArgumentError>(
      [&] {
        ReadDemonstration(Write(*folder_ / "nan", {{kTcp, {0, nan, 0}}, {kCup}}), "");
      },
      "row 1 of column " + kTcp + " is no pose: [nan");
  // An object that is not there in all rows is left out, and the log says so.
  Demonstration demo;
  const std::string log = LogOfReading(
      Write(*folder_ / "gone", {{kTcp}, {kCup}, {"objects/lid/pose", {0, 0, nan}}}), demo);
  EXPECT_THAT(log, HasSubstr("row 2 of column objects/lid/pose is no pose"));
  EXPECT_THAT(demo.bodies, ElementsAre(Pair("cup", SizeIs(3))));
}

TEST_F(SourceDemosTest, TargetsAreThoseThatWereIntendedAtTheBaseOfEachRow) {
  const Demonstration demo =
      ReadDemonstration(Write(*folder_ / "moving", {{"robots/rc7/base_pose", {0, 1, 3}},
                                                    {"robots/rc7/tcp_pose_in_base"},
                                                    {"robots/rc7/action/tcp_pose", {9, 9, 9}},
                                                    {"robots/rc7/intended/tcp_pose"},
                                                    {kCup}}),
                        "rc7");
  for (size_t row = 0; row < 3; ++row) {
    const double x = std::vector<double>{0, 1.01, 3.02}[row];
    EXPECT_DOUBLE_EQ(demo.tcp_in_world[row].translation().x(), x);
    EXPECT_DOUBLE_EQ(demo.target_in_world[row].translation().x(), x);
  }
}

// Pushes an object in the second action, which no control says.
class Pushing : public Commanding {
 public:
  explicit Pushing(bool pushes) : Commanding(Pose(), 6), pushes_(pushes) {}
  Action Act(const Scene& scene, Rng& rng) override {
    Commanding::Act(scene, rng);
    if (++acted_ == 2 && pushes_) {
      const std::string body = scene.compiled()->object("target").root_body;
      const Pose pose = scene.body_pose(body);
      Scene(scene).SetBodyPose(
          body, Pose(pose.translation() + Eigen::Vector3d(0, 0, 0.05), pose.quaternion()));
    }
    return {};
  }

 private:
  bool pushes_;
  int acted_ = 0;
};

using SourceOfDrawersTest = RolloutTest;

TEST_F(SourceOfDrawersTest, DrawersAreThereIfThePlayedControlsGiveTheRecord) {
  start->scene.AddObject(
      {.name = "unit", .mjcf_path = "drawer_unit", .pos = Vec3{3, 3, 0}, .fixed = true});
  for (const bool pushes : {false, true}) {
    Pushing expert(pushes);
    Rollout(expert);
    Demonstration demo;
    const std::string log = LogOfReading(Episode(folder / "e"), demo);
    EXPECT_EQ(demo.bodies.at("target").size(), 6U);
    EXPECT_EQ(demo.bodies.size() > 2, !pushes);
    for (const auto& body : demo.bodies) EXPECT_EQ(body.second.size(), 6U) << body.first;
    if (pushes) {
      EXPECT_THAT(log, HasSubstr("row 2 of column objects/target/pose is 0.0"));
    } else {
      EXPECT_THAT(log, Not(HasSubstr("not used")));
    }
    std::filesystem::remove_all(folder / "e");
  }
  // Nor are they if the controls are not there; the recorded columns are.
  const nlohmann::json metadata{{"scene_spec", ToYaml(start->scene.spec())}};
  Demonstration demo;
  const std::string log =
      LogOfReading(Write(folder / "written", {{kTcp}, {kCup}}, metadata.dump()), demo);
  EXPECT_THAT(log, HasSubstr("drawers, doors and other jointed bodies are not used"));
  EXPECT_THAT(demo.bodies, ElementsAre(Pair("cup", SizeIs(3))));
}

TEST_F(SourceDemosTest, SaysWhatASourceLacks) {
  const auto write = [&](const std::string& name, const std::vector<std::string>& poses) {
    std::vector<PoseColumn> columns;
    for (const std::string& pose : poses) columns.push_back({pose});
    return Write(*folder_ / name, columns);
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
