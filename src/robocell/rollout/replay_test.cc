#include "robocell/rollout/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "robocell/base/error.h"
#include "robocell/data/episode_writer.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/mujoco/names.h"
#include "robocell/rollout/rollout.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// The scripted expert, except that before action `row` it does something that no record contains.
class Meddling : public Expert {
 public:
  using Deed = std::function<void(Scene)>;
  Meddling(std::shared_ptr<Expert> expert, Scene scene, int row, Deed deed)
      : expert_(std::move(expert)), scene_(std::move(scene)), left_(row), deed_(std::move(deed)) {}
  void Begin(const Scene& scene, Rng& rng) override { expert_->Begin(scene, rng); }
  Action Act(const Scene& scene, Rng& rng) override {
    if (left_-- == 0) deed_(scene_);
    return expert_->Act(scene, rng);
  }
  bool done() const override { return expert_->done() || left_ < -20; }
  std::string failure() const override { return ""; }
  int phase() const override { return expert_->phase(); }
  std::vector<std::string> phase_names() const override { return expert_->phase_names(); }

 private:
  std::shared_ptr<Expert> expert_;
  Scene scene_;
  int left_;
  Deed deed_;
};

class ReplayTest : public ::testing::Test {
 protected:
  ReplayTest() {
    run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
    run.cameras.streams = {};
    MakeStart();
  }
  void MakeStart() {
    start.reset();
    Rng rng = Rng::Stream(1, "start");
    for (int attempt = 0; !start; ++attempt)
      start = std::move(StartSampler(run).Sample({0, 0, attempt}, rng).start);
  }
  Episode Record(int row = 1000, Meddling::Deed deed = {}) {
    Meddling expert(MakePickPlanner(run, *start), start->scene, row, std::move(deed));
    Rng rng = Rng::Stream(2, "expert");
    internal::RunRollout(run, *start, expert, rng,
                         {.dataset = folder.path(),
                          .episode_id = "e",
                          .metadata_json = "{}",
                          .keep_failures = true});
    return Episode(folder / "e");
  }

  TempDir folder;
  RunConfig run;
  std::optional<EpisodeStart> start;
};

TEST_F(ReplayTest, ReplayingControlsReproducesAnEpisodeBitwise) {
  const Episode episode = Record();
  const ReplayResult result = VerifyReplay(episode, {.tolerance = 0});
  EXPECT_TRUE(result.ok()) << result.Text();
  EXPECT_EQ(result.rows, episode.rows());
  EXPECT_EQ(result.ticks, episode.rows("control"));
  EXPECT_GT(result.rows, 20);
  EXPECT_THAT(result.Text(), HasSubstr("control ticks: identical"));
}

TEST_F(ReplayTest, BodiesThatSleepWhenTheEpisodeBeginsDoNotMatter) {
  run.options.enable = {"sleep"};
  MakeStart();
  const int* trees = start->scene.data()->tree_asleep;
  ASSERT_TRUE(
      std::any_of(trees, trees + start->scene.model()->ntree, [](int t) { return t >= 0; }));
  const ReplayResult result = VerifyReplay(Record(), {.tolerance = 0});
  EXPECT_TRUE(result.ok()) << result.Text();
}

TEST_F(ReplayTest, ReportsAPushedObjectAndItsRow) {
  const std::string body = start->scene.compiled()->object("target").root_body;
  const Episode episode = Record(7, [body](Scene scene) {
    const Pose pose = scene.body_pose(body);
    scene.SetBodyPose(body,
                      Pose(pose.translation() + Eigen::Vector3d(0.002, 0, 0), pose.quaternion()));
  });
  const ReplayResult result = VerifyReplay(episode);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.first->row, 8);
  EXPECT_EQ(result.first->tick, 8 * run.rates.control_ticks());
  EXPECT_EQ(result.first->what, "object 'target' x");
  EXPECT_EQ(result.first->column, "objects/target/pose");
  EXPECT_NEAR(result.first->recorded - result.first->replayed, 0.002, 5e-4);
  EXPECT_EQ(result.rows, 8);
  EXPECT_THAT(result.Text(), StartsWith("e: differs first in row 8 (control tick 264, t = 0.528"));
  EXPECT_THAT(result.Text(), HasSubstr("object 'target' x: "));
  EXPECT_EQ(result.first->units, "m") << "the value's, not the column's";
  EXPECT_THAT(result.Text(), HasSubstr(" m recorded, "));
}

TEST_F(ReplayTest, ReportsTheFirstJointMovedByAForce) {
  const Episode episode = Record(3, [](Scene scene) {
    const Robot robot = Robot::Of(scene, "rc7");
    scene.SetBodyWrench(ElementName(scene.model(), mjOBJ_BODY, robot.body_ids().back()), {0, 20, 0},
                        {0, 0, 0});
  });
  const ReplayResult result = VerifyReplay(episode);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.first->row, 4);
  EXPECT_THAT(result.first->what, StartsWith("joint 'joint"));
  EXPECT_THAT(result.first->what, HasSubstr(" of rc7/arm"));
  EXPECT_EQ(result.first->units, "rad");
  EXPECT_GT(result.first->others, 0);
}

TEST_F(ReplayTest, ReportsTheTickOfAClockJump) {
  const Episode episode = Record(5, [](Scene scene) { scene.data()->time += 0.01; });
  const ReplayResult result = VerifyReplay(episode);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.first->tick, 5 * run.rates.control_ticks());
  EXPECT_EQ(result.first->what, "the clock");
}

TEST_F(ReplayTest, IgnoresDifferencesBelowTheTolerance) {
  const Episode episode = Record(7, [](Scene scene) { scene.data()->qvel[0] += 1e-13; });
  EXPECT_TRUE(VerifyReplay(episode, {.tolerance = 1e-3}).ok());
  EXPECT_FALSE(VerifyReplay(episode, {.tolerance = 0}).ok());
  ExpectThrow<ArgumentError>([&] { VerifyReplay(episode, {.tolerance = -1}); },
                             "tolerance -1 is not at least 0");
  ExpectThrow<ArgumentError>([&] { VerifyReplay(episode, {.tolerance = NAN}); },
                             "tolerance nan is not at least 0");
}

TEST_F(ReplayTest, RejectsAnEpisodeWithoutAScene) {
  EpisodeSchema schema;
  const ColumnId time = schema.AddColumn({.name = "time", .units = "s"});
  EpisodeWriter writer(folder.path(), "other", schema);
  writer.Put(time, 0.0);
  writer.EndRow();
  writer.Commit({.success = true});
  ExpectThrow<ArgumentError>(
      [&] { VerifyReplay(Episode(folder / "other")); },
      "its metadata has no scene_spec; episodes that robocell generated have one");
}

}  // namespace
}  // namespace robocell
