#include "robocell/robot/arm_ports.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/robot/testing/commanded_robot.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

class ArmPortsTest : public CommandedRobot {};

TEST_F(ArmPortsTest, ErrorsNameTheJointAndPortsRecover) {
  Refuses([&] { robot.SetJntPosCmd(WithNan(home, 1)); }, kArm + ": the target of 'joint2' is nan");
  const std::vector<double> ctrl = Ctrl();
  robot.jnt_pos_cmd()[1] = kNan;
  for (int i = 0; i < 2; ++i) {
    ExpectThrow<ArgumentError>([&] { robot.Update(); },
                               kArm + ": the target of 'joint2' is nan; targets must be finite");
  }
  EXPECT_EQ(Ctrl(), ctrl);
  robot.SetJntPosCmd(home);
  robot.Update();
  EXPECT_TRUE(robot.Step().ok());
}

TEST_F(ArmPortsTest, ErrorsOfEveryPortNameTheJoint) {
  RobotSpec spec{.name = "rc7", .config = Rc7()};
  spec.control_modes = std::vector{CtrlMode::kVelocity, CtrlMode::kTorque};
  robot = Robot::Of(Scene::Build(SceneWith(spec)), "rc7");
  for (const CtrlMode mode : {CtrlMode::kVelocity, CtrlMode::kTorque}) {
    robot.set_ctrl_mode(mode);
    const std::vector<double> ctrl = Ctrl();
    robot.controller("arm").command_port()[2] = kNan;
    ExpectThrow<ArgumentError>([&] { robot.Update(); },
                               kArm + ": the target of 'joint3' is nan; targets must be finite");
    EXPECT_EQ(Ctrl(), ctrl);
  }
}

}  // namespace
}  // namespace robocell::internal
