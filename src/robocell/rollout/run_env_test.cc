#include "robocell/rollout/run_env.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/data/dataset.h"
#include "robocell/rollout/runner.h"
#include "robocell/scene/testing/gates.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

RunConfig WithoutImages(const TempDir& folder) {
  RunConfig run = ExampleRun("demo.yaml");
  run.cameras.streams = {};
  run.output = (folder.path() / "out").string();
  run.episodes = 3;
  return run;
}

// The oracle is an episode of the run: its actions reproduce its rows.
TEST(RunEnv, ReplayingActionsReproducesTheRows) {
  const TempDir folder;
  const RunConfig run = WithoutImages(folder);
  PrepareDataset(run);
  Runner runner(run);
  RunEnv env(run);
  for (const PlanItem& item : MakePlan(run)) {
    const ItemResult result = runner.Run(item);
    ASSERT_TRUE(result.success);
    const Episode episode(std::filesystem::path(run.output) / item.id);
    env.Reset(item.index);
    const std::vector<double> arm = episode.Read<double>("robots/rc7/action/arm");
    const std::vector<double> gripper = episode.Read<double>("robots/rc7/action/gripper");
    RunStep step;
    for (size_t row = 0; row < gripper.size() && !step.terminated; ++row) {
      const CellRow now = env.Row();
      std::span<const double> rest = now.numbers;
      for (const Feature& feature : now.observed.features()) {
        const auto size = static_cast<size_t>(feature.size());
        const std::vector<double> recorded = episode.Read<double>(
            feature.column.name, {.first = static_cast<int64_t>(row), .count = 1});
        EXPECT_TRUE(std::equal(recorded.begin(), recorded.end(), rest.begin()))
            << feature.column.name << " of row " << row;
        rest = rest.subspan(size);
      }
      const auto q = arm.begin() + static_cast<std::ptrdiff_t>(7 * row);
      step = env.Act(
          {{"robots/rc7/action/arm", {q, q + 7}}, {"robots/rc7/action/gripper", {gripper[row]}}});
    }
    EXPECT_TRUE(step.success);
    EXPECT_EQ(step.reason, "success");
  }
}

TEST(RunEnv, EndsAtTheTimeLimitAndThenRequiresAReset) {
  const TempDir folder;
  RunConfig run = WithoutImages(folder);
  run.rates.max_steps = 2;
  RunEnv env(run);
  ExpectThrow<Error>([&] { env.Row(); }, "call reset first");
  env.Reset(0);
  EXPECT_FALSE(env.Act({}).truncated);
  const RunStep last = env.Act({});
  EXPECT_TRUE(last.truncated);
  EXPECT_EQ(last.reason, "timeout");
  ExpectThrow<Error>([&] { env.Act({}); }, "the episode is over; call reset");
  env.Reset(0);
  EXPECT_FALSE(env.Act({}).truncated);
}

TEST(RunEnv, ReportsTheReasonsForAnImpossibleStart) {
  const TempDir folder;
  RunConfig run = WithoutImages(folder);
  run.start.base_height_offset = -5;
  run.max_attempts = 3;
  RunEnv env(run);
  ExpectThrow<Error>([&] { env.Reset(7); },
                     "none of 3 attempts at start 7 was accepted: base: no base");
  ExpectThrow<Error>([&] { env.Reset(7, 1); }, "none of 2 attempts at start 7 was accepted");
  ExpectThrow<ArgumentError>([&] { env.Reset(7, 3); }, "attempts are numbers from 0 to 2, got 3");
  ExpectThrow<ArgumentError>([&] { env.Reset(-1); }, "a number from 0, got -1");
}

TEST(RunEnv, AStoppedResetCountsTheAttemptsThatItMade) {
  const TempDir folder;
  RunConfig run = WithoutImages(folder);
  run.start.base_height_offset = -5;
  run.max_attempts = 30;
  RunEnv env(run);
  const auto text_of = [&](int most_calls) {
    int calls = 0;
    const StopRequest stop = [&] { return ++calls > most_calls; };
    return ExpectThrow<Error>([&] { env.Reset(7, 0, stop); },
                              "at start 7, before one was accepted");
  };
  EXPECT_EQ(text_of(0), "run 'demo': stopped after 0 attempts at start 7, before one was accepted");
  std::string text;  // of the first stop that comes after an attempt
  for (int calls = 1; calls < 10'000; calls *= 2) {
    text = text_of(calls);
    if (text.find("stopped after 0 attempts") == std::string::npos) break;
  }
  EXPECT_THAT(text, AllOf(HasSubstr("stopped after "), HasSubstr("accepted: base: no base"),
                          Not(HasSubstr("30 attempts"))));
}

TEST(RunEnv, ScenesHaveTheDataThatItsOwnerMakes) {
  const TempDir folder;
  int made = 0;
  const DataFactory count = [&](CompiledScene& compiled) -> DataHandle {
    ++made;
    const std::shared_ptr<mjData> data(mj_makeData(compiled.model()), &mj_deleteData);
    return {data.get(), data};
  };
  RunEnv env(WithoutImages(folder), count);
  env.Reset(0);
  EXPECT_GT(made, 0);
}

TEST(RunEnv, AnEpisodeThatAViewerStoppedIsTruncated) {
  const TempDir folder;
  RunEnv env(WithoutImages(folder));
  env.Reset(0);
  const auto gate = GateForTests::Of(env.start().scene, GateForTests::kStop);
  const RunStep step = env.Act({});
  EXPECT_FALSE(step.terminated);
  EXPECT_TRUE(step.truncated);
  EXPECT_THAT(step.reason, HasSubstr("the window is closed"));
}

}  // namespace
}  // namespace robocell
