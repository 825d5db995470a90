// Tests relative joint position: sums on the target, within limits.
#include "robocell/control/relative_joint_controller.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

class RelativeJoint : public ::testing::Test {
 protected:
  void SetUp() override { robot.SetController("arm", "relative_joint_position"); }
  Controller& controller() { return robot.controller("arm"); }
  void Add(int joint, double delta) {
    std::vector<double> d(7);
    d[joint] = delta;
    controller().SetTarget(d);
  }

  Robot robot = RobotAlone(Rc7());
  const std::vector<double> home = Rc7().home.at("arm");
};

TEST_F(RelativeJoint, AddsToTheTargetRatherThanTheMeasuredPosition) {
  EXPECT_EQ(controller().kind(), "relative_joint_position");
  EXPECT_EQ(controller().target_kind(), TargetKind::kJointSteps);
  Add(1, 0.125);
  robot.Update();
  Add(1, 0.125);  // the arm has not moved yet
  EXPECT_EQ(controller().target()[1], 0.125) << "the last one added";
  EXPECT_EQ(controller().commanded_joint_pos()[1], home[1] + 0.25);
  robot.Update();
  EXPECT_EQ(robot.arm().ctrl()[1], home[1] + 0.25);
  EXPECT_EQ(robot.arm().ctrl()[0], home[0]);
  for (int i = 0; i < 1000; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
  EXPECT_NEAR(robot.arm().joint_pos()[1], home[1] + 0.25, 1e-6) << "added once, not every tick";
}

TEST_F(RelativeJoint, StopsAtTheLimitsAndReturnsFromThem) {
  for (int i = 0; i < 100; ++i) Add(0, 0.5);
  EXPECT_EQ(controller().commanded_joint_pos()[0], 2.9);
  Add(0, -0.5);
  EXPECT_EQ(controller().commanded_joint_pos()[0], 2.4);
}

TEST_F(RelativeJoint, ItsPortIsTheAbsoluteTarget) {
  robot.jnt_pos_cmd()[2] = 0.7;
  Add(2, 0.1);
  EXPECT_DOUBLE_EQ(controller().commanded_joint_pos()[2], 0.8);
}

TEST_F(RelativeJoint, AResetClearsItsTarget) {
  Add(0, 1);
  Scene scene = robot.scene();
  scene.Reset();
  EXPECT_EQ(controller().commanded_joint_pos()[0], home[0]);
  EXPECT_EQ(controller().target()[0], 0);
}

TEST_F(RelativeJoint, RejectsInvalidTargetsAndKeepsItsOwn) {
  Add(0, 0.5);
  ExpectThrow<ArgumentError>([&] { controller().SetTarget(std::vector<double>(2)); },
                             "group 'arm': expected 7 joint values, got 2");
  ExpectThrow<ArgumentError>([&] { Add(3, NAN); }, "group 'arm': the target of 'joint4' is nan");
  EXPECT_EQ(controller().commanded_joint_pos()[0], home[0] + 0.5);
  EXPECT_EQ(controller().commanded_joint_pos()[3], home[3]);
}

TEST(RelativeJointConfig, SelectsItForAnArm) {
  RobotConfig config = Rc7();
  config.control["arm"] = ControlKind::kRelativeJointPosition;
  Robot robot = RobotAlone(config);
  EXPECT_EQ(robot.controller("arm").kind(), "relative_joint_position");
  EXPECT_EQ(robot.controller("gripper").kind(), "joint_position");
}

}  // namespace
}  // namespace robocell
