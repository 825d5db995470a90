#include "robocell/base/poll_clock.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace robocell {
namespace {

using namespace std::chrono_literals;

// A clock that only moves when it is set, and counts its readers.
struct ToldClock {
  using duration = std::chrono::microseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ToldClock, duration>;
  static constexpr bool is_steady = true;
  static time_point now() {
    ++asked;
    return at;
  }
  static inline time_point at{};
  static inline int asked = 0;
};

// The results for steps of one length.
struct Told {
  int due = 0, asked = 0;
  std::chrono::microseconds longest{};  // between two times that it was due, or from the start
};

Told Work(BasicPollClock<ToldClock>& clock, int steps, std::chrono::microseconds each) {
  Told told;
  const int asked = ToldClock::asked;
  ToldClock::time_point last = ToldClock::at;
  for (int i = 0; i < steps; ++i) {
    ToldClock::at += each;
    const bool due = clock.IsDue();
    told.longest = std::max(told.longest, ToldClock::at - last);
    if (!due) continue;
    ++told.due;
    last = ToldClock::at;
  }
  told.asked = ToldClock::asked - asked;
  return told;
}

TEST(PollClock, IsDueEveryTenMillisecondsAndRarelyReadsTheClock) {
  BasicPollClock<ToldClock> clock;
  const Told told = Work(clock, 80'000, 10us);
  EXPECT_NEAR(told.due, 80, 2);
  EXPECT_LE(told.longest, 10ms + 8 * 10us);
  EXPECT_LE(told.asked, 80'000 / 8 + 1);
}

TEST(PollClock, IsDueAfterEachLongStep) {
  BasicPollClock<ToldClock> clock;
  const Told told = Work(clock, 20, 100ms);
  EXPECT_EQ(told.due, 20);
  EXPECT_LE(told.longest, 100ms);
}

TEST(PollClock, AdaptsToTheDurationOfSteps) {
  BasicPollClock<ToldClock> clock;
  Work(clock, 1001, 10us);
  const Told slow = Work(clock, 100, 100ms);
  EXPECT_GE(slow.due, 100 - 7);
  EXPECT_LE(slow.longest, 800ms) << "the first of them only";
  EXPECT_EQ(Work(clock, 100, 100ms).due, 100);
  Work(clock, 1, 10us);
  EXPECT_LE(Work(clock, 80'000, 10us).asked, 80'000 / 8 + 1);
}

}  // namespace
}  // namespace robocell
