// Checks that this folder's controllers did not become many times slower, like
// robot/update_cost_test.cc for the plain modes; benchmarks/ measures their speed.
#include <gtest/gtest.h>

#include "robocell/robot/testing/robots.h"
#include "robocell/robot/testing/update_cost.h"

namespace robocell {
namespace {

double CostOf(const std::string& controller) {
  RobotConfig config = Rc7();
  config.gravcomp = false;  // otherwise there is nothing to compensate
  Robot robot = RobotAlone(config);
  robot.SetController("arm", controller);
  return UpdateCost(robot, [] {});
}

// Measured at 8 and 11 % of a step.
TEST(ControllerCost, IsAFractionOfAStep) {
  EXPECT_LT(CostOf("joint_impedance"), Allowed(0.6));
  EXPECT_LT(CostOf("cartesian_impedance"), Allowed(1.0));
}

}  // namespace
}  // namespace robocell
