// Checks that the control loop did not become many times slower; benchmarks/ measures its speed.
#include "robocell/robot/testing/update_cost.h"

#include <gtest/gtest.h>

#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

// Measured at 3 % of a step.
TEST(UpdateCost, IsAFractionOfAStep) {
  Robot robot = RobotAlone(Rc7());
  EXPECT_LT(UpdateCost(robot, [] {}), Allowed(0.3));
}

// Measured at 5 %.
TEST(UpdateCost, WithGravityTorquesIsAFractionOfAStep) {
  Robot robot = RobotAlone(Rc7());
  robot.set_ctrl_mode(CtrlMode::kTorque);
  const auto command = [&] { robot.GravityTorques(robot.jnt_trq_cmd()); };
  EXPECT_LT(UpdateCost(robot, command), Allowed(0.3));
}

}  // namespace
}  // namespace robocell
