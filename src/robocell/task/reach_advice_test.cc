#include "robocell/task/reach_advice.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/task/pick_task_config.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/source_dir.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

RunConfig DemoRun() { return RunConfig::Load(SourceDir() + "/examples/demo.yaml"); }

// Tries the advice: the sampler accepts starts there.
TEST(ReachAdvice, SuggestsAPlaceThatGivesAGrasp) {
  RunConfig run = DemoRun();
  run.start.base_height_offset = 0.3;  // the arm stands above the table
  run.start.base_height_noise = {0, 0};
  const ReachAdvice advice = AdviseReach(run);
  EXPECT_EQ(advice.reached, ReachedPart::kAll);
  const auto [low, high] = advice.distance;
  EXPECT_THAT(
      advice.text,
      AllOf(HasSubstr(fmt::format("a grasp from above, pregrasp and lift included, is in reach "
                                  "with start.base_height_offset {:.2f} and base_distance {:.2f} "
                                  "... {:.2f} m",
                                  advice.height_offset, low, high)),
            HasSubstr("the run says 0.3, with noise 0 ... 0, and "), Not(HasSubstr("give less"))));
  run.start.base_height_offset = advice.height_offset;
  run.start.base_distance = {std::lerp(low, high, 0.4), std::lerp(low, high, 0.8)};
  StartSampler sampler(run);
  int accepted = 0;
  for (int attempt = 0; attempt < 4; ++attempt) {
    Rng rng = Rng::Stream(1, "start", attempt);
    accepted += sampler.Sample({.scene = 0, .episode = 0, .attempt = attempt}, rng).start ? 1 : 0;
  }
  EXPECT_GT(accepted, 0) << advice.text;
}

TEST(ReachAdvice, ReportsAnExcessiveLift) {
  RunConfig run = DemoRun();
  run.task.As<PickTaskConfig>().lift_height = 1.2;
  const ReachAdvice advice = AdviseReach(run);
  EXPECT_EQ(advice.reached, ReachedPart::kPregrasp);
  EXPECT_THAT(advice.text,
              AllOf(HasSubstr("no place of the base lets the arm lift by 1.25 m (task.lift_height, "
                              "1.2 m, and what a grasp slips): give less. Without the lift a grasp "
                              "from above is in reach with start.base_height_offset ")));
}

}  // namespace
}  // namespace robocell::internal
