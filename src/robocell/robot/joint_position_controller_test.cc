// Tests the position port of arms and grippers: tracking, holding still, valid targets.
#include "robocell/robot/joint_position_controller.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/robot/gripper_opening_controller.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

void Simulate(Robot& robot, int steps) {
  for (int i = 0; i < steps; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
}

double LargestError(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

class AnyArm : public ::testing::TestWithParam<RobotCase> {};
INSTANTIATE_TEST_SUITE_P(Robots, AnyArm, ::testing::ValuesIn(AllRobots()), CaseName);

// Returns home, or the nearest positions well inside the limits.
std::vector<double> StartOf(const Robot& robot) {
  std::vector<double> q = robot.arm().joint_pos();
  const std::vector<Interval> limits = robot.joint_limits();
  for (size_t i = 0; i < q.size(); ++i) {
    q[i] = std::clamp(q[i], limits[i].lower + 0.1, limits[i].upper - 0.4);
  }
  return q;
}

TEST_P(AnyArm, TracksATargetOrHoldsStill) {
  REQUIRE_ROBOT(GetParam());
  RobotSpec spec = GetParam().spec();
  spec.name = GetParam().name;
  // Servos sag by gravity's torque over their gain unless it is compensated.
  const bool gravcomp = spec.config.has_value();
  Scene scene = Scene::Build(SceneWith(spec));
  Robot robot = GetParam().robot(scene, GetParam().name);
  std::vector<double> q = StartOf(robot);
  robot.SetJointPos(q);
  Simulate(robot, 1000);
  EXPECT_LT(LargestError(robot.arm().joint_pos(), q), gravcomp ? 1e-5 : 0.02) << "drift in 2 s";
  for (size_t i = 0; i < q.size(); ++i) q[i] += i % 2 == 0 ? 0.3 : -0.1;
  robot.Apply({{"arm", GroupCommand::Joints(q)}});
  Simulate(robot, 1500);
  EXPECT_LT(LargestError(robot.arm().joint_pos(), q), gravcomp ? 0.01 : 0.02) << "after 3 s";
}

TEST(JointPosition, WritesTheTargetItselfToPlainServos) {
  Robot robot = RobotAlone(Rc7());
  const std::vector<double> q{0.123456789, 0.2, -1.0 / 3, 0.4, 0.5, 0.6, 0.7};
  robot.Apply({{"arm", GroupCommand::Joints(q)}});
  robot.Update();
  EXPECT_EQ(robot.arm().ctrl(), q);
}

TEST(JointPosition, TargetsBeyondTheControlRangeStopAtIt) {
  Robot robot = RobotAlone(Rc7());
  robot.Apply({{"arm", GroupCommand::Joints({9, -9, 0, 1, 0, 0, 0})}});
  robot.Update();
  EXPECT_EQ(robot.arm().ctrl()[0], 2.9);
  EXPECT_EQ(robot.arm().ctrl()[1], -1.9);
  EXPECT_EQ(robot.controller("arm").commanded_joint_pos()[0], 9) << "as it was commanded";
}

TEST(JointPosition, FollowsChangesOfTheModel) {
  Robot robot = RobotAlone(Rc7());
  Scene scene = robot.scene();
  robot.jnt_pos_cmd()[0] = 0.5;
  scene.mutable_model()->actuator_gainprm[0] *= 2;  // joint1's servo: now needs half the control
  robot.Update();
  EXPECT_DOUBLE_EQ(robot.arm().ctrl()[0], 0.25);
}

TEST(JointPosition, ErrorsNameGroupAndJoint) {
  Robot robot = RobotAlone(Rc7());
  Controller& controller = robot.controller("arm");
  EXPECT_EQ(controller.target_size(), 7);
  EXPECT_EQ(controller.target_kind(), TargetKind::kJointPositions);
  ExpectThrow<ArgumentError>([&] { controller.SetTarget(std::vector<double>(6)); },
                             "group 'arm': expected 7 joint values, got 6");
  std::vector<double> bad(7);
  bad[1] = INFINITY;
  ExpectThrow<ArgumentError>([&] { controller.SetTarget(bad); },
                             "group 'arm': the target of 'joint2' is inf; targets must be finite");
}

TEST(JointPosition, RequiresServos) {
  ModelFolder folder;
  std::string motors = kTwoJointArm;
  for (const char* tag : {"position", "position"}) {
    motors.replace(motors.find(std::string("<") + tag), 9, "<motor");
  }
  for (const char* gains : {R"( kp="100" kv="10")", R"( kp="50" kv="5")"}) {
    motors.erase(motors.find(gains), std::string(gains).size());
  }
  RobotConfig config = ArmConfig(folder.Write("motors", motors));
  const std::string why =
      "'servo1' is a motor, no position servo: write `control: {arm: joint_impedance}` at the top "
      "level of the robot file, or joint_torque there to command torques, or give the model "
      "position servos";
  Robot robot = RobotAlone(config);
  robot.Update();
  ExpectThrow<NotFoundError>([&] { robot.controller("arm"); },
                             "robot 'arm' / group 'arm' has no controller: " + why);
  config.control["arm"] = ControlKind::kJointPosition;
  ExpectThrow<ArgumentError>([&] { RobotAlone(config); },
                             "group 'arm' cannot be driven to positions: " + why);
}

class GripperOpening : public ::testing::Test {
 protected:
  double Ctrl() { return robot.scene().actuator_ctrl("gripper"); }
  double Target() { return robot.controller("gripper").target()[0]; }

  Robot robot = RobotAlone(Rc7());
};

TEST_F(GripperOpening, IsTheTargetClampedToItsEnds) {
  Controller& controller = robot.controller("gripper");
  EXPECT_EQ(controller.target_size(), 1);
  controller.SetTarget(std::vector<double>{0.3});
  robot.Update();
  EXPECT_DOUBLE_EQ(Ctrl(), 30);
  controller.SetTarget(std::vector<double>{-2});
  EXPECT_EQ(Target(), 0);
  controller.command_port()[0] = 0.5;
  robot.Update();
  EXPECT_DOUBLE_EQ(Ctrl(), 50);
  ExpectThrow<ArgumentError>([&] { controller.SetTarget(std::vector<double>{NAN}); },
                             "group 'gripper': the target of 'opening' is nan");
  controller.command_port()[0] = NAN;
  ExpectThrow<ArgumentError>([&] { robot.Update(); }, "opening cannot be nan");
}

TEST_F(GripperOpening, SetAtTheGroupBecomesTheTarget) {
  robot.gripper().Close();
  Simulate(robot, 500);
  EXPECT_EQ(Ctrl(), 0);
  EXPECT_EQ(Target(), 0);
  EXPECT_LT(robot.gripper().opening(), 0.01);
  robot.gripper().SetOpening(0.6);
  robot.Apply({{"gripper", GroupCommand::Opening(0.2)}});
  robot.Update();
  EXPECT_DOUBLE_EQ(Ctrl(), 20) << "the later command counts";
  robot.scene().SetActuatorCtrl("gripper", 70);
  robot.Update();
  EXPECT_DOUBLE_EQ(Target(), 0.7);
}

// The last command counts even if it equals the actuator's present control.
TEST_F(GripperOpening, TheLastCommandWins) {
  robot.gripper().Open();
  robot.Update();
  robot.Apply({{"gripper", GroupCommand::Opening(0)}});
  robot.gripper().Open();
  robot.Update();
  EXPECT_EQ(Ctrl(), 100);
  EXPECT_EQ(Target(), 1);
  robot.gripper().Close();
  robot.Apply({{"gripper", GroupCommand::Opening(1)}});
  robot.Update();
  EXPECT_EQ(Ctrl(), 100);
}

TEST_F(GripperOpening, SetAtTheGroupOpensTheGripper) {
  for (const bool updated : {true, false}) {
    for (const double opening : {0.0, 1.0}) {
      robot.gripper().SetOpening(opening);
      if (updated) {
        Simulate(robot, 500);
      } else {
        EXPECT_TRUE(robot.scene().StepN(500).ok());
      }
      EXPECT_NEAR(robot.gripper().opening(), opening, 0.02) << updated;
    }
  }
}

TEST_F(GripperOpening, AfterAResetComesFromHomeOrTheHook) {
  Scene scene = robot.scene();
  robot.gripper().Close();
  robot.Update();
  scene.Reset();
  EXPECT_DOUBLE_EQ(Target(), 1);
  scene.AddResetHook([&](ResetContext&) { robot.gripper().Close(); });
  scene.Reset();
  EXPECT_EQ(Target(), 0);
  Simulate(robot, 500);
  EXPECT_LT(robot.gripper().opening(), 0.01);
}

TEST_F(GripperOpening, OfANewHandleMatchesTheActuatorCommand) {
  Scene scene = robot.scene();
  robot.gripper().Close();
  Simulate(robot, 20);  // still far from closed
  ASSERT_GT(robot.gripper().opening(), 0.5);
  robot = RobotAlone(Rc7());  // the last handle to the first robot goes
  Robot again = Robot::Of(scene, "rc7");
  EXPECT_EQ(again.controller("gripper").target()[0], 0);
}

}  // namespace
}  // namespace robocell
