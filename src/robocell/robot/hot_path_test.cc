// Tests that the code of every control tick allocates nothing.
#include <gtest/gtest.h>

#include "robocell/robot/testing/robots.h"
#include "robocell/testing/count_allocations.h"

namespace robocell {
namespace {

void ExpectNoAllocation(Robot& robot) {
  MoveGroup& arm = robot.arm();
  std::vector<double> q = arm.joint_pos(), ctrl = arm.ctrl(), torques(robot.n_joints());
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, arm.nv());
  robot.Update();
  const AllocationCount count;
  for (int i = 0; i < 100; ++i) {
    robot.Update();
    robot.jnt_pos_cmd()[0] += 1e-4;
    robot.SetJntPosCmd(robot.jnt_pos_msr());
    robot.GravityTorques(torques);
    arm.GetJointPos(q);
    arm.NoopCtrl(ctrl);
    arm.SetCtrl(ctrl);
    arm.Jacobian(jacobian);
    (void)arm.leaf_frame_to_robot();
    (void)robot.FkFrame();
    (void)robot.base_in_world();
    if (robot.has_gripper()) (void)robot.gripper().opening();
    if (robot.has_gripper()) (void)robot.gripper().is_grasping();
    EXPECT_TRUE(robot.Step().ok());
  }
  EXPECT_EQ(count.allocations(), 0);
}

TEST(HotPath, OfTheBuiltInRobotAllocatesNothing) {
  Robot robot = RobotAlone(Rc7());
  ExpectNoAllocation(robot);
}

TEST(HotPath, OfAMovingDrivenBaseAllocatesNothing) {
  RobotConfig config = Rc7();
  config.base = {.kind = BaseKind::kDriven};
  Robot robot = RobotAlone(config);
  robot.base().SetTarget(Pose::FromRpy({1, 0, 1}, {0, 0, 1}) * robot.base().pose());
  ExpectNoAllocation(robot);
}

// Forward checks for values written to the model.
TEST(HotPath, OfForwardAllocatesNothing) {
  const Robot robot = RobotAlone(Rc7());
  const AllocationCount count;
  for (int i = 0; i < 10; ++i) robot.scene().Forward();
  EXPECT_EQ(count.allocations(), 0);
}

TEST(HotPath, OfEveryControlModeAllocatesNothing) {
  RobotSpec spec{.name = "rc7", .config = Rc7()};
  spec.control_modes = std::vector{CtrlMode::kVelocity, CtrlMode::kTorque};
  Robot robot = Robot::Of(Scene::Build(SceneWith(spec)), "rc7");
  for (const CtrlMode mode : {CtrlMode::kVelocity, CtrlMode::kTorque}) {
    robot.set_ctrl_mode(mode);
    const AllocationCount count;
    for (int i = 0; i < 10; ++i) {
      robot.Update();
      EXPECT_TRUE(robot.Step().ok());
    }
    EXPECT_EQ(count.allocations(), 0) << ToString(mode);
  }
}

TEST(HotPath, OfForceTorqueSensorsAllocatesNothing) {
  RobotConfig config = Rc7();
  config.attachments.push_back({.mjcf_path = "ft_sensor", .attach_to = Site("tcp")});
  config.ft_sensors = {{.name = "wrist_ft", .frame_site = "tcp", .compensate_tool = true},
                       {.name = "wrist_ft"}};
  config.ft_sensors[1].name = "plain";
  config.ft_sensors[1].force_sensor = "wrist_ft_force";
  config.ft_sensors[1].torque_sensor = "wrist_ft_torque";
  Robot robot = RobotAlone(config);
  ExpectNoAllocation(robot);
  EXPECT_EQ(robot.ft_sensor_names().size(), 2u);
}

TEST(HotPath, OfALinkageGripperAllocatesNothing) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  Robot robot = RobotAlone(XArm7());
  ExpectNoAllocation(robot);
}

}  // namespace
}  // namespace robocell
