#include "robocell/robot/joint_torque_controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

// The built-in robot, whose weight its motors must hold.
class JointTorqueControllerTest : public ::testing::Test {
 protected:
  static Robot InTorqueMode() {
    RobotSpec spec{.name = "rc7", .config = Rc7()};
    spec.config->gravcomp = false;
    spec.control_modes = std::vector{kPosition, kTorque};
    Robot robot = Robot::Of(Scene::Build(SceneWith(spec)), "rc7");
    robot.set_ctrl_mode(CtrlMode::kTorque);
    return robot;
  }
  static void Advance(Robot& robot, int steps) {
    for (int i = 0; i < steps; ++i) {
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
  }

  Robot robot_ = InTorqueMode();
};

// The oracle is the force that the engine's motors apply.
TEST_F(JointTorqueControllerTest, MotorsApplyTheCommandedTorques) {
  const std::vector<double> torques = {1, -2, 3, -4, 0.5, -0.25, 0.125};
  robot_.controller("arm").SetTarget(torques);
  Advance(robot_, 1);
  const std::vector<double> applied = robot_.arm().joint_torque();
  for (size_t i = 0; i < torques.size(); ++i) EXPECT_NEAR(applied[i], torques[i], 1e-9) << i;
}

TEST_F(JointTorqueControllerTest, WithoutACommandTheArmIsHeldAgainstGravity) {
  const std::vector<double> before = robot_.arm().joint_pos();
  Advance(robot_, 200);
  const std::vector<double> after = robot_.arm().joint_pos();
  for (size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-3) << i;
}

TEST_F(JointTorqueControllerTest, AResetHoldsTheArmWhereItIs) {
  Controller& controller = robot_.controller("arm");
  controller.SetTarget(std::vector<double>(7, 0));
  Advance(robot_, 50);  // it falls
  controller.Reset();
  std::vector<double> weight(7);
  robot_.GravityTorques(weight);
  for (size_t i = 0; i < weight.size(); ++i) EXPECT_NEAR(controller.target()[i], weight[i], 1e-9);
}

TEST_F(JointTorqueControllerTest, RejectsTorquesOfAWrongNumberOrThatAreNotFinite) {
  Controller& controller = robot_.controller("arm");
  const std::vector<double> before(controller.target().begin(), controller.target().end());
  EXPECT_THROW(controller.SetTarget(std::vector<double>(6)), ArgumentError);
  std::vector<double> bad(7);
  bad[2] = NAN;
  EXPECT_THROW(controller.SetTarget(bad), ArgumentError);
  EXPECT_THAT(controller.target(), ::testing::ElementsAreArray(before));
}

TEST_F(JointTorqueControllerTest, RequiresAnArm) {
  ExpectThrow<ArgumentError>([&] { MakeJointTorqueController(robot_.group("gripper")); },
                             "controller 'joint_torque' drives arms that have a chain; this group");
}

}  // namespace
}  // namespace robocell::internal
