// Tests that the leaf moves as commanded in the simulation, and that joints stay within limits and
// speeds.
#include "robocell/control/differential_ik_controller.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

DifferentialIkController& Jog(Robot& robot) {
  robot.SetController("arm", "differential_ik");
  return dynamic_cast<DifferentialIkController&>(robot.controller("arm"));
}

void Drive(Robot& robot, double seconds) {
  const int steps = static_cast<int>(std::lround(seconds / robot.scene().timestep()));
  for (int i = 0; i < steps; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
}

TEST(DifferentialIkController, FollowsTheTwistAndStopsAtZero) {
  Robot robot = RobotAlone(Rc7());
  DifferentialIkController& jog = Jog(robot);
  const Pose start = robot.FkFrame();
  jog.SetTwist({.linear = {0, 0.05, -0.03}});
  Drive(robot, 1);
  EXPECT_FALSE(jog.slower());
  const Pose there(start.translation() + Vector3d(0, 0.05, -0.03), start.rotation());
  EXPECT_TRUE(robot.FkFrame(jog.commanded_joint_pos()).is_close(there, 2e-3, 1e-3));
  jog.SetTwist({});
  Drive(robot, 0.5);
  EXPECT_FALSE(jog.slower()) << "it stands as it was told";
  EXPECT_TRUE(robot.FkFrame().is_close(there, 2e-2, 1e-2)) << "the arm itself";
  // About the leaf's own z axis.
  jog.SetFrame(TwistFrame::kTip);
  jog.SetTwist({.angular = {0, 0, 0.4}});
  Drive(robot, 1);
  const Pose turned = there * Pose::FromRotvec(Vector3d::Zero(), Vector3d(0, 0, 0.4));
  EXPECT_TRUE(robot.FkFrame(jog.commanded_joint_pos()).is_close(turned, 4e-3, 4e-3));
  robot.scene().Reset();
  EXPECT_EQ(jog.twist(), Twist{});
}

TEST(DifferentialIkController, AcceptsTwistsInWorldAxes) {
  const Scene scene =
      Scene::Build(SceneWith({.name = "a", .config = Rc7(), .euler = {25, -40, 70}}));
  Robot robot = Robot::Of(scene, "a");
  DifferentialIkController& jog = Jog(robot);
  const Pose base = robot.base_in_world();
  const Pose start = base * robot.FkFrame(jog.commanded_joint_pos());
  jog.SetFrame(TwistFrame::kWorld);
  const Vector3d displacement(0.02, 0.01, 0.04);
  jog.SetTwist({.linear = 2 * displacement});
  Drive(robot, 0.5);
  const Pose there(start.translation() + displacement, start.rotation());
  EXPECT_TRUE((base * robot.FkFrame(jog.commanded_joint_pos())).is_close(there, 2e-3, 1e-3));
}

TEST(DifferentialIkController, ObeysLimitsAndSpeedsAndMovesRedundantJoints) {
  Robot robot = RobotAlone(Rc7());
  DifferentialIkController& jog = Jog(robot);
  const std::vector<double> most(7, 0.3);
  jog.SetMaxSpeed(most);
  jog.SetTwist({.linear = {0.6, 0, 0.1}});  // leads out of reach
  std::vector<double> before(jog.commanded_joint_pos().begin(), jog.commanded_joint_pos().end());
  const double dt = robot.scene().timestep();
  bool slower = false;
  for (int k = 0; k < 1500; ++k) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
    slower |= jog.slower();
    for (int i = 0; i < 7; ++i) {
      const double q = jog.commanded_joint_pos()[i];
      EXPECT_LE(std::abs(q - before[i]), 0.3 * dt + 1e-12);
      EXPECT_GE(q, robot.joint_limits()[i].lower - 1e-12);
      EXPECT_LE(q, robot.joint_limits()[i].upper + 1e-12);
      before[i] = q;
    }
  }
  EXPECT_TRUE(slower);
  robot.scene().Reset();
  const Pose start = robot.FkFrame(jog.commanded_joint_pos());
  std::vector<double> posture(jog.posture().begin(), jog.posture().end());
  posture[0] += 0.6;
  jog.SetPosture(posture);
  const double at_first = jog.commanded_joint_pos()[0];
  Drive(robot, 1);
  EXPECT_GT(std::abs(jog.commanded_joint_pos()[0] - at_first), 0.02);
  EXPECT_TRUE(robot.FkFrame(jog.commanded_joint_pos()).is_close(start, 2e-3, 2e-3));
}

TEST(DifferentialIkController, RejectsInvalidNumbers) {
  Robot robot = RobotAlone(Rc7());
  DifferentialIkController& jog = Jog(robot);
  ExpectThrow<ArgumentError>([&] { jog.SetTarget(std::vector<double>(3)); },
                             "group 'arm': expected 6 twist values, got 3");
  ExpectThrow<ArgumentError>([&] { jog.SetMaxSpeed(std::vector<double>(7)); },
                             "the largest speed of joint 'joint1' cannot be 0; it must be above 0");
  ExpectThrow<ArgumentError>([&] { jog.SetPostureRate(-1); },
                             "the rate of the posture cannot be -1; it must be 0 or more");
  ExpectThrow<ArgumentError>([&] { robot.SetController("gripper", "differential_ik"); },
                             "a gripper cannot have the controller 'differential_ik'");
  jog.command_port()[2] = NAN;
  robot.Update();
  EXPECT_TRUE(robot.Step().ok());
  ExpectThrow<ArgumentError>([&] { robot.Update(); }, "nan");
}

}  // namespace
}  // namespace robocell
