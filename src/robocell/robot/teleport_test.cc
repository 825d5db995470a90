// Tests that a teleported arm stays in place, whatever drives it afterwards.
#include <gtest/gtest.h>

#include <vector>

#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

class Teleported : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Updated, Teleported, testing::Bool());

TEST_P(Teleported, ArmsStayInPlaceWithAnyNewController) {
  const bool updated = GetParam();
  Robot robot = RobotAlone(Rc7());
  Scene scene = robot.scene();
  for (const char* kind : {"cartesian_pose", "differential_ik", "relative_joint_position",
                           "joint_position", "joint_impedance"}) {
    for (const bool forward : {true, false}) {
      scene.Reset();
      std::vector<double> q = robot.arm().joint_pos();
      for (double& joint : q) joint += 0.05;
      robot.SetJointPos(q, forward);
      if (updated) robot.Update();
      robot.SetController("arm", kind);
      EXPECT_LT(Drift(robot, 200), 1e-6) << kind << (forward ? ", forward" : "");
    }
  }
}

TEST(Teleport, AnArmIsHeldBeforeItIsUpdated) {
  Robot robot = RobotAlone(Rc7());
  Drift(robot, 50);
  std::vector<double> q = robot.arm().joint_pos();
  for (double& joint : q) joint += 0.05;
  robot.SetJointPos(q);
  for (const double torque : robot.arm().joint_torque()) EXPECT_NEAR(torque, 0, 1e-9);
  const Eigen::Vector3d start = robot.tcp_in_world().translation();
  ASSERT_TRUE(robot.StepN(200).ok());
  robot.SetController("arm", "cartesian_pose");
  Drift(robot, 200);
  EXPECT_LT((robot.tcp_in_world().translation() - start).norm(), 1e-6);
}

TEST(Teleport, WithoutForwardIsVisibleOnDemand) {
  Robot robot = RobotAlone(Rc7());
  const std::vector<double> q{0.3, 0.2, -0.1, 1.2, 0.4, 0.5, -1};
  robot.SetJointPos(q, false);
  EXPECT_EQ(robot.arm().joint_pos(), q);
  EXPECT_TRUE(robot.arm().leaf_frame_to_robot().is_close(robot.FkFrame(q), 1e-12, 1e-12));
}

}  // namespace
}  // namespace robocell
