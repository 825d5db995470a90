// PollClock: says when to look for what is to be heard within milliseconds, such as Ctrl-C, in work
// whose steps may take microseconds or seconds:
//
//   PollClock clock;
//   while (Work()) {
//     if (clock.IsDue()) LookForSignals();
//   }
//
// Asking for the time costs 50 ns on some machines: while steps are quick only each eighth asks.
#pragma once

#include <chrono>

namespace robocell {

template <class Clock>
class BasicPollClock {
 public:
  // Returns true if 10 ms have passed since it was made, or last said so. Said with the first step
  // after that; up to seven steps later when those before took less than 1 ms each.
  bool IsDue() {
    if (++steps_ < steps_to_ask_) return false;
    const auto now = Clock::now();
    steps_to_ask_ = now - asked_ < steps_ * kQuick ? kMostSteps : 1;
    steps_ = 0;
    asked_ = now;
    if (now < due_) return false;
    due_ = now + kPeriod;
    return true;
  }

 private:
  static constexpr int kMostSteps = 8;
  static constexpr std::chrono::milliseconds kQuick{1}, kPeriod{10};

  typename Clock::time_point asked_ = Clock::now(), due_ = asked_ + kPeriod;
  int steps_ = 0, steps_to_ask_ = 1;
};

using PollClock = BasicPollClock<std::chrono::steady_clock>;

}  // namespace robocell
