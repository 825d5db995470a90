// For tests only: the overhead of the control loop over the engine's steps.
#pragma once

#include <gtest/gtest.h>

#include "robocell/robot/robot.h"
#include "robocell/testing/ratio_of_times.h"

namespace robocell {

// Returns the time of `command` and an update before each step, in steps.
template <class Command>
double UpdateCost(Robot& robot, const Command& command) {
  constexpr int kTicks = 100;
  const auto loop = [&] {
    for (int i = 0; i < kTicks; ++i) {
      command();
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
  };
  const auto steps = [&] {
    for (int i = 0; i < kTicks; ++i) ASSERT_TRUE(robot.Step().ok());
  };
  return RatioOfTimes(loop, steps) - 1;
}

}  // namespace robocell
