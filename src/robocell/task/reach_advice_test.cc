#include "robocell/task/reach_advice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "robocell/task/pick_task_config.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/source_dir.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

RunConfig DemoRun() { return RunConfig::Load(SourceDir() + "/examples/demo.yaml"); }

// Returns the number that follows a text.
double After(const std::string& text, const std::string& before) {
  const size_t at = text.find(before);
  return at == std::string::npos ? NAN : std::strtod(text.c_str() + at + before.size(), nullptr);
}

// Tries the advice: the sampler accepts starts there.
TEST(ReachAdvice, SuggestsAPlaceThatGivesAGrasp) {
  RunConfig run = DemoRun();
  run.start.base_height_offset = 0.3;  // the arm stands above the table
  run.start.base_height_noise = {0, 0};
  const std::string advice = ReachAdvice(run);
  EXPECT_THAT(advice, AllOf(HasSubstr("a grasp from above, pregrasp and lift included, is in reach "
                                      "with start.base_height_offset "),
                            HasSubstr("the run says 0.3, with noise 0 ... 0, and "),
                            Not(HasSubstr("give less"))));
  const double low = After(advice, "base_distance "), high = After(advice, " ... ");
  run.start.base_height_offset = After(advice, "base_height_offset ");
  run.start.base_distance = {std::lerp(low, high, 0.4), std::lerp(low, high, 0.8)};
  StartSampler sampler(run);
  int accepted = 0;
  for (int attempt = 0; attempt < 4; ++attempt) {
    Rng rng = Rng::Stream(1, "start", attempt);
    accepted += sampler.Sample({.scene = 0, .episode = 0, .attempt = attempt}, rng).start ? 1 : 0;
  }
  EXPECT_GT(accepted, 0) << advice;
}

TEST(ReachAdvice, ReportsAnExcessiveLift) {
  RunConfig run = DemoRun();
  run.task.As<PickTaskConfig>().lift_height = 1.2;
  EXPECT_THAT(ReachAdvice(run),
              AllOf(HasSubstr("no place of the base lets the arm lift by 1.25 m (task.lift_height, "
                              "1.2 m, and what a grasp slips): give less. Without the lift a grasp "
                              "from above is in reach with start.base_height_offset ")));
}

}  // namespace
}  // namespace robocell::internal
