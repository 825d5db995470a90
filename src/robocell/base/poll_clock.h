// PollClock: decides when to poll for events that need a reaction within milliseconds, such as
// Ctrl-C, in work whose steps may take microseconds or seconds:
//
//   PollClock clock;
//   while (Work()) {
//     if (clock.IsDue()) LookForSignals();
//   }
//
// Reading the time costs 50 ns on some machines: during quick steps only every eighth one reads it.
#pragma once

#include <chrono>

namespace robocell {

template <class Clock>
class BasicPollClock {
 public:
  // Returns true if 10 ms have passed since construction, or since it last returned true. It
  // returns true with the first step after that; up to seven steps later if the previous ones took
  // less than 1 ms each.
  bool IsDue() {
    if (++steps_ < steps_to_read_) return false;
    const auto now = Clock::now();
    steps_to_read_ = now - last_read_ < steps_ * kQuick ? kMostSteps : 1;
    steps_ = 0;
    last_read_ = now;
    if (now < due_) return false;
    due_ = now + kPeriod;
    return true;
  }

 private:
  static constexpr int kMostSteps = 8;
  static constexpr std::chrono::milliseconds kQuick{1}, kPeriod{10};

  typename Clock::time_point last_read_ = Clock::now(), due_ = last_read_ + kPeriod;
  int steps_ = 0, steps_to_read_ = 1;
};

using PollClock = BasicPollClock<std::chrono::steady_clock>;

}  // namespace robocell
