// RealTimePacer: lets simulated time pass no faster than the wall clock. A delay is not caught up.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace robocell::internal {

class RealTimePacer {
 public:
  void Start(double simulated_s) {
    start_ = Clock::now();
    simulated_start_ = simulated_s;
  }
  // Returns when as much time has passed since Start as in the simulation. `poll`, if set, is
  // called every few milliseconds; its exception ends the wait.
  void Wait(double simulated_s, const std::function<void()>& poll = {}) {
    const std::chrono::duration<double> simulated(simulated_s - simulated_start_);
    const auto due = start_ + std::chrono::duration_cast<Clock::duration>(simulated);
    if (Clock::now() > due) return Start(simulated_s);
    while (poll && due - Clock::now() > kBetweenPolls) {
      std::this_thread::sleep_for(kBetweenPolls);
      poll();
    }
    std::this_thread::sleep_until(due);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kBetweenPolls{10};
  Clock::time_point start_ = Clock::now();
  double simulated_start_ = 0;
};

}  // namespace robocell::internal
