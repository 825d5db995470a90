// That the control loop's cost did not collapse: far from how fast it is, which benchmarks/ tells.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

template <class Function>
double Seconds(const Function& function) {
  const auto begin = std::chrono::steady_clock::now();
  function();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Measured at 1 % of a step; whatever disturbs a machine only ever adds, so the minimum counts.
TEST(UpdateCost, IsAFractionOfAStep) {
  Robot robot = RobotAlone(Rc7());
  constexpr int kTicks = 100;
  double update = std::numeric_limits<double>::infinity(), step = update;
  for (int repetition = 0; repetition < 20; ++repetition) {
    update = std::min(update, Seconds([&] {
                        for (int i = 0; i < kTicks; ++i) robot.Update();
                      }));
    step = std::min(step, Seconds([&] { ASSERT_TRUE(robot.scene().StepN(kTicks).ok()); }));
  }
  EXPECT_LT(update, 0.3 * step);
}

}  // namespace
}  // namespace robocell
