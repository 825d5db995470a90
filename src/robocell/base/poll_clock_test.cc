#include "robocell/base/poll_clock.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace robocell {
namespace {

using namespace std::chrono_literals;

// A clock that only moves when it is set, and counts its readers.
struct ManualClock {
  using duration = std::chrono::microseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ManualClock, duration>;
  static constexpr bool is_steady = true;
  static time_point now() {
    ++reads;
    return at;
  }
  static inline time_point at{};
  static inline int reads = 0;
};

// The results for steps of one length.
struct PollCounts {
  int due = 0, reads = 0;
  std::chrono::microseconds longest{};  // between two times that it was due, or from the start
};

PollCounts Work(BasicPollClock<ManualClock>& clock, int steps, std::chrono::microseconds each) {
  PollCounts counts;
  const int reads = ManualClock::reads;
  ManualClock::time_point last = ManualClock::at;
  for (int i = 0; i < steps; ++i) {
    ManualClock::at += each;
    const bool due = clock.IsDue();
    counts.longest = std::max(counts.longest, ManualClock::at - last);
    if (!due) continue;
    ++counts.due;
    last = ManualClock::at;
  }
  counts.reads = ManualClock::reads - reads;
  return counts;
}

TEST(PollClock, IsDueEveryTenMillisecondsAndRarelyReadsTheClock) {
  BasicPollClock<ManualClock> clock;
  const PollCounts counts = Work(clock, 80'000, 10us);
  EXPECT_NEAR(counts.due, 80, 2);
  EXPECT_LE(counts.longest, 10ms + 8 * 10us);
  EXPECT_LE(counts.reads, 80'000 / 8 + 1);
}

TEST(PollClock, IsDueAfterEachLongStep) {
  BasicPollClock<ManualClock> clock;
  const PollCounts counts = Work(clock, 20, 100ms);
  EXPECT_EQ(counts.due, 20);
  EXPECT_LE(counts.longest, 100ms);
}

TEST(PollClock, AdaptsToTheDurationOfSteps) {
  BasicPollClock<ManualClock> clock;
  Work(clock, 1001, 10us);
  const PollCounts slow = Work(clock, 100, 100ms);
  EXPECT_GE(slow.due, 100 - 7);
  EXPECT_LE(slow.longest, 800ms) << "the first of them only";
  EXPECT_EQ(Work(clock, 100, 100ms).due, 100);
  Work(clock, 1, 10us);
  EXPECT_LE(Work(clock, 80'000, 10us).reads, 80'000 / 8 + 1);
}

}  // namespace
}  // namespace robocell
