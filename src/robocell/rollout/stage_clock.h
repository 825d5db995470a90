// StageClock: how long each stage of a piece of work takes. Stages nest: while an inner one runs,
// the outer one stands still, so that no second counts twice.
//
//   StageClock clock;
//   StageClock::Stage acting(clock, times.acting);
//   { StageClock::Stage writing(clock, times.writing); Write(); }   // not counted as acting
//
// One thread.
#pragma once

#include <chrono>

namespace robocell::internal {

template <class Clock>
class BasicStageClock {
 public:
  // Adds to `total` (seconds) what passes until it goes out of scope, less the stages within.
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
  // Returns the stage that ran until now.
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
