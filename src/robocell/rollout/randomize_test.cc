// `randomize:` in runs: drawn with the start, recorded, replayed to the bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/data/episode_reader.h"
#include "robocell/mujoco/names.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/randomized_record.h"
#include "robocell/rollout/replay.h"
#include "robocell/rollout/rollout.h"
#include "robocell/rollout/start_draw.h"
#include "robocell/rollout/testing/rollout_test_base.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/sampler_kind.h"
#include "robocell/task/task_kind.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

RunConfig Randomized(const std::string& block) {
  RunConfig run = Demo();
  run.cameras.streams = {};
  run.randomize = FromYamlUnchecked<RandomizeConfig>(block);
  return run;
}

EpisodeStart Draw(const RunConfig& run, int episode = 0) {
  const std::shared_ptr<TaskSampler> sampler = MakeSampler(run);
  for (int attempt = 0;; ++attempt) {
    SampleResult drawn =
        DrawStart({run, *sampler, {}}, {.scene = 0, .episode = episode}, attempt, {});
    if (drawn.start) return std::move(*drawn.start);
  }
}

constexpr const char* kAll =
    "lights: {number: {choice: [1, 2]}}\n"
    "appearance: {table: {texture: [wood]}, robots: {colour: {scale: {uniform: [0.5, 1]}}}}\n"
    "dynamics: {objects: {mass: {scale: {uniform: [0.5, 2]}}, friction: {scale: {uniform: [0.8, "
    "1.2]}}}, robots: {damping: {scale: {uniform: [0.5, 2]}}}}\n"
    "action_delay: {uniform: [0.01, 0.06]}\n"
    "clutter: {number: 2}\n";

TEST(RunRandomize, AnEpisodeRecordsItsValuesAndIsReplayedToTheBit) {
  const RunConfig run = Randomized(kAll);
  EpisodeStart start = Draw(run);
  BindStart(start, run);
  const RandomizedValues values = start.randomized;
  EXPECT_EQ(values.at("clutter/number").numbers.front(), 2);
  EXPECT_TRUE(start.scene.compiled()->object("clutter_1").free_joint);
  const Pose leaf = Robot::Of(start.scene, "rc7").FkFrame();
  Commanding expert(leaf * Pose(Eigen::Vector3d(0, 0, 0.05)), 6);
  const TempDir folder;
  Rng rng = Rng::Stream(2, "expert");
  RunRollout(
      run, start, expert, rng,
      {.dataset = folder.path(), .episode_id = "e", .metadata_json = "{}", .keep_failures = true});
  const Episode episode(folder / "e");
  EXPECT_EQ(RandomizedOf(episode).size(), values.size());
  for (const auto& [name, value] : values.entries())
    EXPECT_EQ(RandomizedOf(episode).at(name), *value) << name;
  const ReplayResult replayed = VerifyReplay(episode, {.tolerance = 0});
  EXPECT_TRUE(replayed.ok()) << replayed.Text();
  EXPECT_EQ(replayed.rows, episode.rows());
}

TEST(RunRandomize, StartsDifferAndTheBlockMovesNothingElse) {
  const RunConfig run = Randomized("dynamics: {objects: {mass: {scale: {uniform: [0.5, 2]}}}}");
  RunConfig plain = run;
  plain.randomize.reset();
  const EpisodeStart varied = Draw(run), other = Draw(run, 1), without = Draw(plain);
  EXPECT_EQ(varied.scene.state(), without.scene.state());
  EXPECT_TRUE(without.randomized.empty());
  EXPECT_NE(varied.randomized, other.randomized);
  const int target = FindId(varied.scene.model(), mjOBJ_BODY, "target");
  EXPECT_NE(varied.scene.model()->body_mass[target], without.scene.model()->body_mass[target]);
}

TEST(RunRandomize, OncePerSceneIsTheSameInItsEpisodes) {
  RunConfig run = Randomized("dynamics: {robots: {damping: {scale: {uniform: [0.5, 2]}}}}");
  run.randomize->every = RandomizeEvery::kScene;
  EXPECT_EQ(Draw(run).randomized, Draw(run, 1).randomized);
}

TEST(RunRandomize, TheValuesOfAnEpisodePinARun) {
  const RunConfig run = Randomized(kAll);
  const EpisodeStart drawn = Draw(run, 3);
  RunConfig pinned = run;
  pinned.randomize->pinned = drawn.randomized;
  pinned.seed = 99;
  const EpisodeStart again = Draw(pinned);
  for (const char* name : {"light/number", "table/texture", "table/texture_seed",
                           "rc7/damping_scale", "target/mass_scale", "clutter/0/kind"})
    EXPECT_EQ(again.randomized.at(name), drawn.randomized.at(name)) << name;
}

}  // namespace
}  // namespace robocell::internal
