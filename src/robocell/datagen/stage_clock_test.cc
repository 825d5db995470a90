#include "robocell/datagen/stage_clock.h"

#include <gtest/gtest.h>

#include <thread>

namespace robocell {
namespace {

using std::chrono::milliseconds;

TEST(StageClock, AnOuterStageStandsStillWhileAnInnerOneRuns) {
  StageClock clock;
  double outer = 0, inner = 0;
  const auto begin = std::chrono::steady_clock::now();
  {
    const StageClock::Stage first(clock, outer);
    for (int i = 0; i < 2; ++i) {
      const StageClock::Stage second(clock, inner);
      std::this_thread::sleep_for(milliseconds(15));
    }
    std::this_thread::sleep_for(milliseconds(5));
  }
  const double whole =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GE(inner, 0.030);
  EXPECT_GE(outer, 0.005);
  EXPECT_LE(inner + outer, whole);
  EXPECT_GE(inner + outer, 0.99 * whole - 1e-3);
  std::this_thread::sleep_for(milliseconds(5));
  { const StageClock::Stage third(clock, inner); }
  EXPECT_LE(inner + outer, whole) << "what passes between stages belongs to none";
}

}  // namespace
}  // namespace robocell
