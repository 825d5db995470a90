#include "robocell/control/joint_impedance_controller.h"

#include <gtest/gtest.h>

#include <vector>

#include "robocell/base/error.h"
#include "robocell/control/testing/tilted_arm.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

class JointImpedance : public ::testing::TestWithParam<RobotCase> {
 protected:
  Scene Build() { return TiltedScene(GetParam()); }
  Robot In(const Scene& scene) { return BentArm(scene, GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Robots, JointImpedance, ::testing::ValuesIn(AllRobots()), CaseName);

TEST_P(JointImpedance, AJointYieldsLikeASpring) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build();
  Robot robot = In(scene);
  auto& impedance = robot.SetController<JointImpedanceController>("arm");
  const std::vector<double> start = robot.arm().joint_pos();
  RunFor(robot, 200);
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(robot.arm().joint_pos()[i], start[i], 2e-3) << "it weighs nothing";
  }
  const double push = 0.02 * impedance.stiffness()[3];
  scene.data()->qfrc_applied[robot.chain().joints()[3].dof_address] = push;
  RunFor(robot, 1500);
  EXPECT_NEAR(robot.arm().joint_pos()[3] - start[3], 0.02, 1e-3);
}

TEST(JointImpedanceTarget, IsSetByPortsAndActions) {
  Robot robot = RobotAlone(Rc7());
  robot.SetController<JointImpedanceController>("arm");
  EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kTorque);
  robot.jnt_pos_cmd()[3] += 0.1;
  const double target = robot.jnt_pos_cmd()[3];
  RunFor(robot, 1000);
  EXPECT_NEAR(robot.arm().joint_pos()[3], target, 5e-3);
  std::vector<double> q = robot.arm().joint_pos();
  q[0] += 0.2;
  robot.Apply({{"arm", GroupCommand::Joints(q)}});
  EXPECT_EQ(robot.jnt_pos_cmd()[0], q[0]);
}

TEST(JointImpedanceGains, AreChecked) {
  Robot robot = RobotAlone(Rc7());
  auto& impedance = robot.SetController<JointImpedanceController>("arm");
  impedance.SetStiffness(std::vector<double>{250});
  EXPECT_EQ(impedance.stiffness()[6], 250);
  ExpectThrow<ArgumentError>([&] { impedance.SetStiffness(std::vector<double>(3, 1)); },
                             "group 'arm': stiffness has 3 values; give 1 or 7");
  ExpectThrow<ArgumentError>([&] { impedance.SetDampingRatio(-1); },
                             "group 'arm': damping_ratio cannot be -1; it must be 0 or more");
  ExpectThrow<ArgumentError>([&] { robot.SetController("gripper", "joint_impedance"); },
                             "a gripper cannot have the controller 'joint_impedance'");
}

}  // namespace
}  // namespace robocell
