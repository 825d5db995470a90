#include "robocell/rollout/stage_clock.h"

#include <gtest/gtest.h>

namespace robocell::internal {
namespace {

// A clock that the test advances.
struct HandClock {
  using duration = std::chrono::duration<double>;
  using time_point = std::chrono::time_point<HandClock, duration>;
  static inline double seconds = 100;
  static time_point now() { return time_point(duration(seconds)); }
};

using Clock = BasicStageClock<HandClock>;

void Pass(double seconds) { HandClock::seconds += seconds; }

TEST(StageClock, AnOuterStagePausesDuringAnInnerOne) {
  Clock clock;
  double outer = 0, inner = 0;
  {
    const Clock::Stage first(clock, outer);
    for (int i = 0; i < 2; ++i) {
      const Clock::Stage second(clock, inner);
      Pass(15);
    }
    Pass(5);
  }
  EXPECT_DOUBLE_EQ(inner, 30);
  EXPECT_DOUBLE_EQ(outer, 5);
}

TEST(StageClock, TimeBetweenStagesIsNotCounted) {
  Clock clock;
  double total = 0;
  Pass(3);
  { const Clock::Stage first(clock, total); }
  Pass(7);
  {
    const Clock::Stage second(clock, total);
    Pass(2);
  }
  EXPECT_DOUBLE_EQ(total, 2);
}

}  // namespace
}  // namespace robocell::internal
