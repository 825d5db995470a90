#include "robocell/rollout/run_cell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "robocell/task/sampler_kind.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

// A start of the demo without images.
class RunCellTest : public ::testing::Test {
 protected:
  RunCellTest() {
    run.cameras.streams = {};
    const std::shared_ptr<TaskSampler> sampler = MakeSampler(run);
    Rng rng = Rng::Stream(1, "run cell");
    for (int attempt = 0; !start; ++attempt)
      start = std::move(sampler->Sample({0, 0, attempt}, rng).start);
  }

  RunConfig run = ExampleRun("demo.yaml");
  std::optional<EpisodeStart> start;
};

TEST_F(RunCellTest, ObservesTheStartAndLendsItsTask) {
  RunCell in(run, *start, nullptr);
  EXPECT_EQ(start->task.use_count(), 1) << "an owner in another language has the only reference";
  const std::span<const double> read = in.features.ReadState();
  const CellRow row = in.Row();
  EXPECT_EQ(row.numbers.size(), static_cast<size_t>(row.observed.size()));
  EXPECT_TRUE(std::ranges::equal(row.numbers, read));
  EXPECT_NO_THROW(row.observed.Find("objects/target/pose"));
  EXPECT_TRUE(row.images.images().empty());
}

TEST_F(RunCellTest, StepsAtTheRatesOfTheRun) {
  RunCell in(run, *start, nullptr);
  const double before = start->scene.time();
  const CellStep step = in.cell.Step({.send = [&] { return in.cell.Send({}); }});
  EXPECT_TRUE(step.ok());
  EXPECT_FALSE(step.verdict.success);
  EXPECT_NEAR(start->scene.time() - before, 1 / run.rates.policy_rate().value(), 1e-12);
}

}  // namespace
}  // namespace robocell::internal
