// StageClock: measures how long each stage of some work takes. Stages nest: the outer one stops
// while an inner one runs, so that no second counts twice.
//
//   StageClock clock;
//   StageClock::Stage acting(clock, times.acting);
//   { StageClock::Stage writing(clock, times.writing); Write(); }   // not counted as acting
//
// Use it from one thread.
#pragma once

#include <chrono>

namespace robocell::internal {

template <class Clock>
class BasicStageClock {
 public:
  // Adds the time until it goes out of scope to `total` (seconds), less that of the stages within.
  class Stage {
   public:
    Stage(BasicStageClock& clock, double& total) : clock_(clock), outer_(clock.SwitchTo(&total)) {}
    ~Stage() { clock_.SwitchTo(outer_); }
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

   private:
    BasicStageClock& clock_;
    double* outer_;
  };

 private:
  // Starts a stage and returns the one that ran until now.
  double* SwitchTo(double* total) {
    const auto now = Clock::now();
    if (running_) *running_ += std::chrono::duration<double>(now - since_).count();
    double* before = running_;
    running_ = total;
    since_ = now;
    return before;
  }

  double* running_ = nullptr;
  typename Clock::time_point since_ = {};
};

using StageClock = BasicStageClock<std::chrono::steady_clock>;

}  // namespace robocell::internal
