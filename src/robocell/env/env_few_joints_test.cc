// Tests arms of fewer than six joints under actions that are poses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "robocell/base/log.h"
#include "robocell/env/env.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using Numbers = std::vector<double>;

// A desktop arm: a pan, three hinges in a vertical plane, and a roll. Its tip lies beside the plane,
// so that no rotation stays as it is when the arm pans.
constexpr const char* kDesktopArm = R"(<compiler angle="radian"/>
  <default><geom contype="0" conaffinity="0"/></default><worldbody><body name="base">
  <geom type="box" size=".04 .04 .02" pos="0 0 .02"/>
  <body name="shoulder" pos="0 0 .06"><joint name="pan" axis="0 0 1" range="-2 2"/><geom size=".02"/>
  <body name="upper"><joint name="lift" axis="0 1 0" range="-2 2"/>
    <geom type="capsule" size=".015" fromto="0 0 0 0 0 .15" mass=".2"/>
  <body name="lower" pos="0 0 .15"><joint name="elbow" axis="0 1 0" range="-2.5 2.5"/>
    <geom type="capsule" size=".015" fromto="0 0 0 .15 0 0" mass=".2"/>
  <body name="wrist" pos=".15 0 0"><joint name="flex" axis="0 1 0" range="-2 2"/>
    <geom size=".02" mass=".1"/>
  <body name="hand"><joint name="roll" axis="1 0 0" range="-3 3"/><geom size=".02" mass=".1"/>
    <site name="tip" pos=".08 .01 0"/></body></body></body></body></body></body></worldbody>
  <actuator><position name="a1" joint="pan" kp="200" kv="12"/>
  <position name="a2" joint="lift" kp="200" kv="12"/><position name="a3" joint="elbow" kp="200" kv="9"/>
  <position name="a4" joint="flex" kp="50" kv="3"/><position name="a5" joint="roll" kp="50" kv="1"/>
  </actuator>)";

class EnvFewJoints : public ::testing::Test {
 protected:
  EnvConfig Config(ControlMode mode) {
    RobotConfig robot{.name = "desk", .model = folder_.Write("desk", kDesktopArm)};
    robot.gravcomp = true;
    robot.move_groups["arm"] = {.kind = MoveGroupKind::kArm,
                                .joints = {"pan", "lift", "elbow", "flex", "roll"},
                                .leaf = ElementRef{.kind = ElementKind::kSite, .name = "tip"}};
    robot.home["arm"] = {0.2, 0.3, 0.4, 0.5, 0.1};
    EnvConfig config;
    config.robots["desk"] = robot;
    config.control_mode = mode;
    return config;
  }

  ModelFolder folder_;
};

TEST_F(EnvFewJoints, StepsReachThePositionWithTheNearestRotation) {
  Env env(Config(ControlMode::kCartesianTrpy));
  for (const std::array<double, 3>& step :
       {std::array{0.0, 0.005, 0.0}, std::array{0.005, 0.0, 0.0}, std::array{0.0, 0.0, -0.005}}) {
    env.Reset({.seed = 1});
    const Robot robot = Robot::Of(env.scene(), "desk");
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector3d before = robot.tcp_in_world().translation();
      const EnvStep result = env.Step(Numbers{step[0], step[1], step[2], 0, 0, 0});
      ASSERT_TRUE(result.reason == EndReason::kArrived || result.reason == EndReason::kSettled)
          << i;
      const Eigen::Vector3d moved = robot.tcp_in_world().translation() - before;
      EXPECT_NEAR((moved - Eigen::Vector3d(step[0], step[1], step[2])).norm(), 0, 1.5e-3) << i;
    }
    EXPECT_NEAR(env.motions()[0].position_shortfall, 0, 1e-4);
  }
  env.Reset({.seed = 1});
  env.Step(Numbers{0, 0.005, 0, 0, 0, 0});
  EXPECT_GT(env.motions()[0].rotation_shortfall, 1e-3) << "the arm pans";
  EXPECT_LT(env.motions()[0].rotation_shortfall, 0.05);
}

TEST_F(EnvFewJoints, LeafPosesReachThePosition) {
  Env env(Config(ControlMode::kJoints));
  env.Reset({.seed = 1});
  Robot robot = Robot::Of(env.scene(), "desk");
  const Pose tcp = robot.FkFrame(robot.arm().joint_pos());
  const Pose target(tcp.translation() + Eigen::Vector3d(0.01, 0.02, -0.01), tcp.quaternion());
  const Robot::ApplyResult result = robot.Apply({{"arm", GroupCommand::LeafPose(target)}});
  EXPECT_TRUE(result.ok);
  EXPECT_LE(result.ik.position_error, 1e-5);
  EXPECT_GT(result.ik.rotation_error, 1e-3);
  const auto sent = robot.controller("arm").commanded_joint_pos();
  EXPECT_NEAR((robot.FkFrame(sent).translation() - target.translation()).norm(), 0, 1e-5);
  EXPECT_FALSE(
      robot.Apply({{"arm", GroupCommand::LeafPose(Pose({3, 0, 0}, tcp.quaternion()))}}).ok);
}

TEST_F(EnvFewJoints, TheEnvironmentSaysWhatItsPosesMean) {
  std::vector<std::string> warnings;
  const auto made = [&](ControlMode mode) {
    warnings.clear();
    const ScopedLogSink sink([&](LogLevel, std::string_view text) { warnings.emplace_back(text); });
    Env env(Config(mode));
    return warnings;
  };
  const std::string few = "an arm of 5 degrees of freedom cannot take every pose";
  EXPECT_THAT(made(ControlMode::kCartesianTquat), Contains(HasSubstr(few)));
  EXPECT_THAT(made(ControlMode::kJoints), Not(Contains(HasSubstr(few))));
}

// Of a position, any rotation will do: no shortfall, and nothing to warn of.
TEST_F(EnvFewJoints, ATaskSpaceChoosesWhatCounts) {
  std::vector<std::string> logged;
  EnvConfig config = Config(ControlMode::kCartesianTrpy);
  config.robots.at("desk").move_groups.at("arm").task_space =
      TaskSpaceConfig{.kind = TaskSpaceKind::kPosition};
  const ScopedLogSink sink([&](LogLevel, std::string_view text) { logged.emplace_back(text); });
  Env env(config);
  EXPECT_THAT(logged, Not(Contains(HasSubstr("cannot take every pose"))));
  EXPECT_THAT(logged, Contains(HasSubstr("of actions that are poses the position alone counts")));
  env.Reset({.seed = 1});
  const Robot robot = Robot::Of(env.scene(), "desk");
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector3d before = robot.tcp_in_world().translation();
    const EnvStep result = env.Step(Numbers{0, 0.005, 0, 0.1, 0.2, 0.1});
    ASSERT_TRUE(result.reason == EndReason::kArrived || result.reason == EndReason::kSettled) << i;
    const Eigen::Vector3d moved = robot.tcp_in_world().translation() - before;
    EXPECT_NEAR((moved - Eigen::Vector3d(0, 0.005, 0)).norm(), 0, 1.5e-3) << i;
    EXPECT_EQ(env.motions()[0].rotation_shortfall, 0) << i;
  }
}

TEST_F(EnvFewJoints, AConfiguredPoseIsReachedAsAWholeOrNotAtAll) {
  EnvConfig config = Config(ControlMode::kJoints);
  config.robots.at("desk").move_groups.at("arm").task_space = TaskSpaceConfig{};
  Env env(config);
  env.Reset({.seed = 1});
  Robot robot = Robot::Of(env.scene(), "desk");
  const Pose tcp = robot.FkFrame(robot.arm().joint_pos());
  const Pose target(tcp.translation() + Eigen::Vector3d(0.01, 0.02, -0.01), tcp.quaternion());
  EXPECT_FALSE(robot.Apply({{"arm", GroupCommand::LeafPose(target)}}).ok);
}

TEST_F(EnvFewJoints, InverseKinematicsOfTheRobotKeepsItsTaskSpace) {
  RobotConfig config = Config(ControlMode::kJoints).robots.at("desk");
  const Pose target = RobotAlone(config).FkFrame() *
                      Pose::FromRotvec(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.3, 0.4, 0.5));
  EXPECT_FALSE(RobotAlone(config).Ik(target).success);
  config.move_groups.at("arm").task_space = TaskSpaceConfig{.kind = TaskSpaceKind::kPosition};
  const Robot robot = RobotAlone(config);
  const IkResult found = robot.Ik(target);
  EXPECT_TRUE(found.success);
  EXPECT_LE((robot.FkFrame(found.q).translation() - target.translation()).norm(), 1e-5);
  EXPECT_FALSE(robot.Ik(target, {.axis = Eigen::Vector3d::UnitX()}).success)
      << "an argument replaces it";
}

// The controller moves at control rate, without the inverse kinematics of commands.
TEST_F(EnvFewJoints, TheCartesianControllerReachesThePosition) {
  for (const bool any_rotation : {false, true}) {
    RobotConfig config = Config(ControlMode::kJoints).robots.at("desk");
    if (any_rotation) {
      config.move_groups.at("arm").task_space = TaskSpaceConfig{.kind = TaskSpaceKind::kPosition};
    }
    config.control["arm"] = ControlKind::kCartesianPose;
    Robot robot = RobotAlone(config);
    robot.scene().Reset();
    const Pose tcp = robot.FkFrame(robot.arm().joint_pos());
    const Pose target(tcp.translation() + Eigen::Vector3d(0.01, 0.05, -0.02), tcp.quaternion());
    EXPECT_TRUE(robot.Apply({{"arm", GroupCommand::LeafPose(target)}}).ok);
    for (int i = 0; i < 1500; ++i) {
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
    const auto sent = robot.controller("arm").commanded_joint_pos();
    EXPECT_NEAR((robot.FkFrame(sent).translation() - target.translation()).norm(), 0, 2e-4)
        << any_rotation;
  }
}

}  // namespace
}  // namespace robocell
