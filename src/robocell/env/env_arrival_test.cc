// Tests the meaning of "arrived" against the engine, and robots with more arms than an environment
// uses.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/log.h"
#include "robocell/base/units.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/env.h"
#include "robocell/env/testing/envs.h"
#include "robocell/env/testing/one_hinge.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/torso.h"

namespace robocell {
namespace {

using Numbers = std::vector<double>;

constexpr double kHinge = 0.002, kSlide = 2e-4;  // of the default `arrival_tolerance`, rad and m
constexpr double kSettling = 0.1;                // s

// A joint's distance from its target and its speed, by the engine.
struct JointState {
  double error, speed;
};
JointState StateOf(const Scene& scene, const std::string& joint, double wanted) {
  const mjModel* m = scene.model();
  const int id = FindId(m, mjOBJ_JOINT, joint);
  return {std::abs(scene.data()->qpos[m->jnt_qposadr[id]] - wanted),
          std::abs(scene.data()->qvel[m->jnt_dofadr[id]])};
}

// A carriage whose servo takes 0.2 s for most of a displacement, and a hinge on it.
EnvConfig Rail(ModelFolder& folder) {
  RobotConfig robot{.name = "rail", .model = folder.Write("rail", R"(
    <compiler angle="radian" autolimits="true"/>
    <worldbody><body name="rail"><geom type="box" size="0.5 0.05 0.02"/>
      <body name="carriage" pos="0 0 0.1">
        <joint name="slide" type="slide" axis="1 0 0" range="-0.5 0.5"/><geom size="0.05" mass="2"/>
        <body name="link" pos="0 0 0.1"><joint name="turn" axis="0 0 1" range="-2 2"/>
          <geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0" mass="0.5"/>
          <site name="tip" pos="0.3 0 0"/></body></body></body></worldbody>
    <actuator><position name="slide" joint="slide" kp="1000" kv="200"/>
      <position name="turn" joint="turn" kp="50" kv="5"/></actuator>)")};
  robot.gravcomp = true;
  robot.move_groups["arm"] = {.kind = MoveGroupKind::kArm,
                              .joints = {"slide", "turn"},
                              .actuators = {"slide", "turn"},
                              .leaf = ElementRef{.kind = ElementKind::kSite, .name = "tip"}};
  EnvConfig config;
  config.robots["robot"] = robot;
  config.control_mode = ControlMode::kJoints;
  config.relative_to = RelativeTo::kNone;
  config.sim.max_convergence_time = 5;
  return config;
}

TEST(EnvArrival, ASlideIsWithinAMillimetreAndSlow) {
  ModelFolder folder;
  Env env(Rail(folder));
  env.Reset({.seed = 1});
  for (const double x : {0.1, 0.1, -0.2, -0.195, -0.1945}) {
    ASSERT_EQ(env.Step(Numbers{x, 5 * x}).reason, EndReason::kArrived);
    const JointState slide = StateOf(env.scene(), "robotrobot_slide", x),
                     turn = StateOf(env.scene(), "robotrobot_turn", 5 * x);
    EXPECT_LE(slide.error, kSlide) << x;
    EXPECT_LE(slide.speed, kSlide / kSettling) << x;
    EXPECT_LE(turn.error, kHinge) << x;
    EXPECT_LE(turn.speed, kHinge / kSettling) << x;
  }
}

TEST(EnvArrival, ToleranceAndSpeedAreThoseOfTheRobotsFile) {
  ModelFolder folder;
  EnvConfig config = Rail(folder);
  config.robots["robot"].arrival_tolerance = 0.001;
  Env env(config);
  env.Reset({.seed = 1});
  ASSERT_EQ(env.Step(Numbers{0.2, 1}).reason, EndReason::kArrived);
  EXPECT_LE(StateOf(env.scene(), "robotrobot_slide", 0.2).error, 1e-4);
  EXPECT_LE(StateOf(env.scene(), "robotrobot_slide", 0.2).speed, 1e-4 / kSettling);
  EXPECT_LE(StateOf(env.scene(), "robotrobot_turn", 1).error, 1e-3);
  EXPECT_LE(StateOf(env.scene(), "robotrobot_turn", 1).speed, 1e-3 / kSettling);
}

// A servo that follows its control 0.3 s later: until then the arm rests far from its target.
TEST(EnvArrival, AStepOfAnArmWithADelayEndsAfterTheDelayAndTheMotion) {
  ModelFolder folder;
  EnvConfig config = OneHinge(folder, "damping='2'", true, "delay='0.3' nsample='151'");
  config.relative_to = RelativeTo::kNone;
  config.sim.max_convergence_time = 5;
  Env env(config);
  env.Reset({.seed = 1});
  for (const double target : {0.4, -0.2, -0.2, 0.0}) {
    const double before = env.scene().joint_pos("robotrobot_hip"), begin = env.scene().time();
    EXPECT_EQ(env.Step(Numbers{target}).reason, EndReason::kArrived) << target;
    const JointState state = StateOf(env.scene(), "robotrobot_hip", target);
    EXPECT_LE(state.error, kHinge) << target;
    EXPECT_LE(state.speed, kHinge / kSettling) << target;
    if (std::abs(target - before) > kHinge) {
      EXPECT_GT(env.scene().time() - begin, 0.3) << target;
    }
    const double held = env.scene().joint_pos("robotrobot_hip");
    Scene scene = env.scene();
    EXPECT_TRUE(scene.StepN(250).ok());  // the control of the end is still on its way
    EXPECT_NEAR(env.scene().joint_pos("robotrobot_hip"), held, kHinge) << target;
  }
  config.sim.max_convergence_time = 0.2;
  Env hasty(config);
  hasty.Reset({.seed = 1});
  EXPECT_EQ(hasty.Step(Numbers{0.4}).reason, EndReason::kTimeout)
      << "an arm that waits is not settled";
}

EnvConfig OneRc7(RelativeTo relative_to) {
  EnvConfig config;
  config.robots["robot"] = Rc7();
  config.control_mode = ControlMode::kJoints;
  config.relative_to = relative_to;
  return config;
}

TEST(EnvArrival, HingeStepsOfAnySizeEndNearAndSlow) {
  Env env(OneRc7(RelativeTo::kLastStep));
  env.Reset({.seed = 1});
  const Robot robot = Robot::Of(env.scene(), "robot");
  Rng rng = Rng::Stream(2, "arrival");
  for (int i = 0; i < 30; ++i) {
    Numbers action(8, 1);  // the last is the gripper's
    const double most = i % 2 ? 0.2 : 0.008;
    for (int j = 0; j < 7; ++j) action[j] = rng.Uniform(-most, most);
    ASSERT_EQ(env.Step(action).reason, EndReason::kArrived) << i;
    const auto wanted = robot.controller("arm").commanded_joint_pos();
    for (size_t j = 0; j < 7; ++j) {
      const JointState joint = StateOf(env.scene(), robot.joint_names()[j], wanted[j]);
      EXPECT_LE(joint.error, kHinge) << i << " " << robot.joint_names()[j];
      EXPECT_LE(joint.speed, kHinge / kSettling) << i << " " << robot.joint_names()[j];
    }
  }
}

// Returns the largest distance of the TCP from its target while every joint is within its
// tolerance.
double TcpTolerance(const Robot& robot) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, robot.n_joints());
  robot.arm().Jacobian(jacobian);
  double most = 0;
  for (int i = 0; i < robot.n_joints(); ++i) most += kHinge * jacobian.col(i).head<3>().norm();
  return most;
}

// Sends one arm of two to `there` from the reset state, and the other to its own position.
EndReason SendOneOf(Env& env, size_t arm, const Pose& there) {
  env.Reset({.seed = 1});
  Numbers action;
  for (size_t i = 0; i < 2; ++i) {
    const auto seen = env.observation().begin() + env.layout().robots[i].tquat.begin;
    Numbers tquat(seen, seen + 7);
    if (i == arm) internal::PutTquat(there, tquat);
    action.insert(action.end(), tquat.begin(), tquat.end());
    action.push_back(1);
  }
  return env.Step(action).reason;
}

TEST(EnvArrival, ArmsSentToOnePoseAgreeWithinTheirJointTolerances) {
  EnvConfig config = Rc7Duo(ControlMode::kCartesianTquat, RelativeTo::kNone);
  config.sim.max_convergence_time = 5;
  Env env(config);
  Rng rng = Rng::Stream(1, "env arrival");
  int both = 0;
  for (int i = 0; i < 20; ++i) {
    const Pose down = Pose::FromRpy({0.35, 0, 0.3}, {internal::kPi, 0, 0});
    const Pose there =
        internal::MovedBy(down, Pose::FromRpy(RandomVector(rng, 0.1), RandomVector(rng, 0.5)));
    int arrived = 0;
    Eigen::Vector3d place[2];
    double tolerance = 0;
    for (size_t arm = 0; arm < 2; ++arm) {
      if (SendOneOf(env, arm, there) != EndReason::kArrived) continue;  // out of reach
      ++arrived;
      const Robot robot = Robot::Of(env.scene(), env.layout().robots[arm].robot);
      place[arm] = robot.tcp_in_world().translation();
      tolerance += TcpTolerance(robot);
    }
    if (arrived < 2) continue;
    ++both;
    EXPECT_LE((place[0] - place[1]).norm(), tolerance);
  }
  EXPECT_GE(both, 5);
}

// Each arm of a robot has its own part of the vectors, and moves the same joints as by its name.
TEST(EnvArms, OfOneRobotActTogether) {
  ModelFolder folder;
  std::vector<std::string> warnings;
  const ScopedLogSink sink([&](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarn) warnings.emplace_back(text);
  });
  EnvConfig config;
  config.robots["t"] = Torso(folder, {"r", "l"});
  config.control_mode = ControlMode::kJoints;
  Env env(config);
  EXPECT_THAT(warnings, ::testing::IsEmpty());
  std::vector<std::string> names;
  for (const RobotLayout& arm : env.layout().robots) names.push_back(arm.robot);
  EXPECT_THAT(names, ::testing::ElementsAre("t/l_arm", "t/r_arm"));
  ASSERT_EQ(env.layout().action.size(), 6);
  EXPECT_EQ(env.layout().commanded.features()[2].column.name, "action/t/r_arm/joints");
  env.Reset({.seed = 1});
  const Robot robot = Robot::Of(env.scene(), "t");
  const std::vector<double> left = robot.group("l_arm").joint_pos();
  for (int i = 0; i < 5; ++i) env.Step(Numbers{0, 0, 0, 0.05, -0.05, 1});
  EXPECT_LE(StateOf(env.scene(), "robott_r1", 0.25).error, kHinge);
  EXPECT_LE(StateOf(env.scene(), "robott_r2", -0.25).error, kHinge);
  for (size_t j = 0; j < left.size(); ++j)
    EXPECT_NEAR(robot.group("l_arm").joint_pos()[j], left[j], 0.01);
  const auto opening = [&](const char* hand) {
    return dynamic_cast<const GripperGroup&>(robot.group(hand)).opening();
  };
  EXPECT_GT(opening("r_hand"), 0.9);
  EXPECT_LT(opening("l_hand"), 0.1);
  // The observation of an arm is its own.
  const RobotLayout& right = env.layout().robots[1];
  EXPECT_NEAR(env.observation()[right.joints.begin], robot.group("r_arm").joint_pos()[0], 1e-9);
  EXPECT_EQ(env.observation()[right.gripper], 1) << "its command";
  EXPECT_EQ(env.observation()[env.layout().robots[0].gripper], 0);
}

TEST(EnvArms, AcceptsARobotWithOneArm) {
  std::vector<std::string> lines;
  const ScopedLogSink sink([&](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarn) lines.emplace_back(text);
  });
  Env env(OneRc7(RelativeTo::kNone));
  EXPECT_THAT(lines, ::testing::IsEmpty());
}

}  // namespace
}  // namespace robocell
