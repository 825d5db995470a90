// Tests actions and observations of an environment.
#include "robocell/env/env.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/env_scene.h"
#include "robocell/env/testing/envs.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kIk = 3e-5;  // inverse kinematics ends within 1e-5 m and rad

using Numbers = std::vector<double>;

// Returns the same action for every robot, with its gripper open.
Numbers ForAll(const Env& env, const Numbers& command, double gripper = 1) {
  Numbers action;
  for (const RobotLayout& robot : env.layout().robots) {
    action.insert(action.end(), command.begin(), command.end());
    if (robot.has_gripper) action.push_back(gripper);
  }
  return action;
}

Numbers Tquat(const Pose& pose) {
  Numbers out(pose.translation().begin(), pose.translation().end());
  out.insert(out.end(), pose.quaternion().begin(), pose.quaternion().end());
  return out;
}

Numbers Part(const Env& env, const VectorPart& part) {
  const auto begin = env.observation().begin() + part.begin;
  return {begin, begin + part.size};
}

Pose ObservedTcp(const Env& env, size_t robot = 0) {
  return internal::PoseOfAction(ControlMode::kCartesianTquat,
                                Part(env, env.layout().robots[robot].tquat));
}

Numbers ObservedJoints(const Env& env, size_t robot = 0) {
  return Part(env, env.layout().robots[robot].joints);
}

Pose SharedToWorld(const Env& env) { return env.scene().shared_base_frame_to_world(); }

// Returns the last target of a robot, in the world: forward kinematics of its commanded joints.
Pose SentInWorld(const Env& env, const std::string& name) {
  const Robot robot = Robot::Of(env.scene(), name);
  return robot.base_in_world() * robot.FkFrame(robot.controller("arm").commanded_joint_pos());
}

Env Ready(const EnvConfig& config) {
  Env env(config);
  env.Reset();
  return env;
}

TEST(EnvFrames, TheSamePoseMovesAllArmsToTheSameWorldPose) {
  EnvConfig config = Rc7Duo(ControlMode::kCartesianTquat, RelativeTo::kNone);
  config.sim.max_convergence_time = 0.002;  // they would meet there
  Env env = Ready(config);
  Rng rng = Rng::Stream(1, "env frames");
  int reached = 0;
  for (int i = 0; i < 40; ++i) {
    const Pose down = Pose::FromRpy({0.35, 0, 0.3}, {internal::kPi, 0, 0});
    const Pose pose =
        internal::MovedBy(down, Pose::FromRpy(RandomVector(rng, 0.1), RandomVector(rng, 0.5)));
    if (!env.Step(ForAll(env, Tquat(pose))).ik_failed.empty()) continue;  // out of reach of one
    if (env.motions()[0].position_shortfall + env.motions()[1].position_shortfall > 0) continue;
    ++reached;
    const Pose wanted = SharedToWorld(env) * pose;
    EXPECT_TRUE(SentInWorld(env, "left").is_close(wanted, kIk, kIk));
    EXPECT_TRUE(SentInWorld(env, "right").is_close(wanted, kIk, kIk));
  }
  EXPECT_GE(reached, 10);
}

TEST(EnvFrames, ObservationsAreForwardKinematicsInTheSharedFrame) {
  Env env = Ready(Rc7Duo(ControlMode::kJoints, RelativeTo::kLastStep));
  for (int step = 0; step < 5; ++step) {
    env.Step(ForAll(env, {0.05, -0.05, 0.02, 0.05, 0, 0.05, 0.05}));
    for (size_t i = 0; i < 2; ++i) {
      const Robot robot = Robot::Of(env.scene(), env.layout().robots[i].robot);
      const Pose world = robot.base_in_world() * robot.FkFrame(ObservedJoints(env, i));
      EXPECT_TRUE((SharedToWorld(env) * ObservedTcp(env, i)).is_close(world, 1e-9, 1e-9));
      const Pose from_rpy = internal::PoseOfAction(ControlMode::kCartesianTrpy,
                                                   Part(env, env.layout().robots[i].xyzrpy));
      EXPECT_TRUE(from_rpy.is_close(ObservedTcp(env, i), 1e-9, 1e-9));
    }
  }
}

TEST(EnvFrames, RelativeRotationsAreAboutTheTcpInSharedFrameAxes) {
  EnvConfig config = Rc7Duo(ControlMode::kCartesianTrpy, RelativeTo::kLastStep);
  Env env = Ready(config);
  const Pose before[] = {ObservedTcp(env, 0), ObservedTcp(env, 1)};
  const Pose turn = Pose::FromRpy({0, 0, 0}, {0.1, -0.2, 0.3});
  EXPECT_THAT(env.Step(ForAll(env, {0, 0, 0, 0.1, -0.2, 0.3})).ik_failed, IsEmpty());
  for (size_t i = 0; i < 2; ++i) {
    const Pose sent = SharedToWorld(env).inverse() * SentInWorld(env, env.layout().robots[i].robot);
    EXPECT_TRUE(sent.is_close(internal::MovedBy(before[i], turn), kIk, kIk)) << i;
    EXPECT_LT((sent.translation() - before[i].translation()).norm(), kIk);
  }
}

TEST(EnvFrames, ConfiguredOriginRotationsStartFromTheOrigin) {
  Env env = Ready(Rc7Duo(ControlMode::kCartesianTrpy, RelativeTo::kConfiguredOrigin));
  const Pose origins[] = {ObservedTcp(env, 0), ObservedTcp(env, 1)};
  const Numbers actions[] = {
      {0, 0, 0, 0.1, -0.2, 0.3}, {0.02, -0.03, 0.01, -0.2, 0.1, 0.2}, {0, 0, 0, 0, 0, 0}};
  for (const Numbers& a : actions) {
    const Pose delta = Pose::FromRpy({a[0], a[1], a[2]}, {a[3], a[4], a[5]});
    EXPECT_THAT(env.Step(ForAll(env, a)).ik_failed, IsEmpty());
    for (size_t i = 0; i < 2; ++i) {
      const Pose sent =
          SharedToWorld(env).inverse() * SentInWorld(env, env.layout().robots[i].robot);
      EXPECT_TRUE(sent.is_close(internal::MovedBy(origins[i], delta), kIk, kIk)) << i;
    }
  }
}

TEST(EnvActions, JointsAreAbsoluteOrRelativeToTheLastTarget) {
  Env absolute = Ready(Rc7Env(ControlMode::kJoints, RelativeTo::kNone));
  const Numbers goal = {0.3, -0.3, 0.2, 1.7, 0.1, 1.2, 0.1};
  EXPECT_EQ(absolute.Step(ForAll(absolute, goal)).reason, EndReason::kArrived);
  const Numbers reached = ObservedJoints(absolute);
  for (size_t i = 0; i < 7; ++i) EXPECT_NEAR(reached[i], goal[i], 0.0101);

  Env relative = Ready(Rc7Env());
  const Numbers home = ObservedJoints(relative);
  for (int step = 0; step < 3; ++step) relative.Step(ForAll(relative, {0, 0, 0, 0, 0, 0, 0.05}));
  const auto sent = Robot::Of(relative.scene(), "robot").controller("arm").commanded_joint_pos();
  EXPECT_NEAR(sent[6], home[6] + 0.15, 1e-12);
}

TEST(EnvActions, SlowRampsArrive) {
  Env env = Ready(Rc7Env(ControlMode::kCartesianTrpy));
  const Pose before = ObservedTcp(env);
  for (int step = 0; step < 200; ++step) env.Step(ForAll(env, {0, 0, 2e-4, 0, 0, 1e-4}));
  const Pose wanted = internal::MovedBy(before, Pose::FromRpy({0, 0, 0.04}, {0, 0, 0.02}));
  EXPECT_TRUE(SentInWorld(env, "robot").is_close(wanted, kIk, kIk));
}

TEST(EnvActions, StepsAreLimitedFromTheLastTarget) {
  EnvConfig config = Rc7Env(ControlMode::kCartesianTquat, RelativeTo::kNone);
  config.max_relative_movement = {0.02, 0.05};
  Env env = Ready(config);
  const Pose start = ObservedTcp(env);
  const Pose goal = internal::MovedBy(start, Pose::FromRpy({0.05, 0, 0.05}, {0, 0, 0.2}));
  Pose last = start;
  for (int step = 0; step < 5; ++step) {
    env.Step(ForAll(env, Tquat(goal)));
    const Pose sent = SentInWorld(env, "robot");
    EXPECT_LE((sent.translation() - last.translation()).norm(), 0.02 + kIk);
    EXPECT_LE(AngleBetween(sent.quaternion(), last.quaternion()), 0.05 + kIk);
    last = sent;
  }
  EXPECT_TRUE(last.is_close(goal, kIk, kIk));
}

TEST(EnvActions, ConfiguredOriginMotionsAreLimitedFromTheLastTarget) {
  EnvConfig config = Rc7Env(ControlMode::kCartesianTrpy, RelativeTo::kConfiguredOrigin);
  config.max_relative_movement = {0.02, 0.1};
  Env env = Ready(config);
  const Pose origin = ObservedTcp(env);
  for (const double x : {0.02, 0.04, 0.05, 0.05}) {
    env.Step(ForAll(env, {0.05, 0, 0, 0, 0, 0}));
    const Pose moved = internal::MovedBy(origin, Pose(Eigen::Vector3d(x, 0, 0)));
    EXPECT_TRUE(SentInWorld(env, "robot").is_close(moved, kIk, kIk)) << x;
  }
}

TEST(EnvActions, AConfiguredOriginStaysUntilItIsSetAgain) {
  Env env = Ready(Rc7Env(ControlMode::kCartesianTrpy, RelativeTo::kConfiguredOrigin));
  const Pose origin = ObservedTcp(env);
  const Pose up = internal::MovedBy(origin, Pose(Eigen::Vector3d(0, 0, 0.03)));
  for (int step = 0; step < 2; ++step) {
    env.Step(ForAll(env, {0, 0, 0.03, 0, 0, 0}));
    EXPECT_TRUE(SentInWorld(env, "robot").is_close(up, kIk, kIk));
  }
  env.SetOriginToCurrent("robot");
  env.Step(ForAll(env, {0, 0, 0.03, 0, 0, 0}));
  EXPECT_TRUE(SentInWorld(env, "robot")
                  .is_close(internal::MovedBy(up, Pose(Eigen::Vector3d(0, 0, 0.03))), kIk, kIk));
  ExpectThrow<NotFoundError>([&] { env.SetOriginToCurrent("robto"); },
                             "environment 'env': no robot 'robto'. Its robots: robot. Did you mean "
                             "'robot'?");
}

TEST(EnvActions, ReportsAnUnreachablePoseAndRetries) {
  Env env = Ready(Rc7Duo(ControlMode::kCartesianTquat, RelativeTo::kNone));
  const Pose left = ObservedTcp(env, 0), right = ObservedTcp(env, 1);
  Numbers action = ForAll(env, Tquat(left));
  const Numbers far = Tquat(Pose(Eigen::Vector3d(9, 0, 0)));
  std::copy(far.begin(), far.end(), action.begin() + env.layout().robots[1].action.begin);
  for (int step = 0; step < 2; ++step) {
    const EnvStep out = env.Step(action);
    EXPECT_EQ(out.reason, EndReason::kIkFailed);
    EXPECT_THAT(out.ik_failed, ElementsAre("right"));
  }
  EXPECT_TRUE(SentInWorld(env, "right").is_close(SharedToWorld(env) * right, kIk, kIk));
  const Numbers near = Tquat(right);
  std::copy(near.begin(), near.end(), action.begin() + env.layout().robots[1].action.begin);
  EXPECT_EQ(env.Step(action).reason, EndReason::kArrived);
}

TEST(EnvActions, GripperActionsAreBinaryOrContinuous) {
  EnvConfig config = Rc7Env();
  Env binary = Ready(config);
  const Numbers still(7, 0);
  const int gripper = binary.layout().robots[0].gripper;
  EXPECT_EQ(binary.observation()[gripper], 1);
  for (const auto& [command, seen] :
       std::vector<std::pair<double, double>>{{0.49, 0}, {0.5, 1}, {0, 0}, {1, 1}}) {
    EXPECT_EQ(binary.Step(ForAll(binary, still, command)).reason, EndReason::kArrived);
    EXPECT_EQ(binary.observation()[gripper], seen) << command;
    EXPECT_NEAR(Robot::Of(binary.scene(), "robot").gripper().opening(), seen, 0.02);
  }
  config.wrappers.binary_gripper = false;
  Env continuous = Ready(config);
  continuous.Step(ForAll(continuous, still, 0.3));
  EXPECT_NEAR(continuous.observation()[gripper], 0.3, 0.02);
}

TEST(EnvActions, AZeroRelativeActionHoldsStill) {
  Env env = Ready(Rc7Env(ControlMode::kCartesianTquat));
  const Pose start = SentInWorld(env, "robot");
  const EnvStep step = env.Step(Numbers(8, 0));
  EXPECT_THAT(step.ik_failed, IsEmpty());
  EXPECT_TRUE(SentInWorld(env, "robot").is_close(start, kIk, kIk));
}

TEST(EnvActions, RejectsInvalidActionsBeforeMoving) {
  Env env(Rc7Env(ControlMode::kCartesianTquat, RelativeTo::kNone));
  Numbers action(8, 0);
  ExpectThrow<Error>([&] { (void)env.Step(action); },
                     "environment 'env': call reset before the first step");
  env.Reset();
  ExpectThrow<ArgumentError>([&] { (void)env.Step(Numbers(7)); },
                             "environment 'env': expected an action of 8 numbers, got 7");
  ExpectThrow<ArgumentError>([&] { (void)env.Step(action); },
                             "environment 'env' / robot 'robot': the quaternion of its tquat is "
                             "zero, which is not a rotation; for none write [0, 0, 0, 1] (xyzw)");
  action[6] = 1, action[2] = NAN;
  ExpectThrow<ArgumentError>([&] { (void)env.Step(action); },
                             "environment 'env' / robot 'robot': number 2 of its tquat is nan");
  EXPECT_EQ(env.scene().time(), 0);
}

TEST(EnvSteps, AtAFixedRateDoNotDrift) {
  EnvConfig config = Rc7Env();
  config.sim.async_control = true;
  config.sim.frequency = 30;
  Env env = Ready(config);
  const Numbers still = ForAll(env, Numbers(7, 0));
  std::vector<int> ticks;
  double last = 0;
  for (int step = 1; step <= 30; ++step) {
    const EnvStep out = env.Step(still);
    EXPECT_GE(out.time, step / 30.0 - 1e-9);
    EXPECT_LT(out.time, step / 30.0 + config.sim.timestep);
    ticks.push_back(static_cast<int>(std::lround((out.time - last) / config.sim.timestep)));
    last = out.time;
  }
  EXPECT_NEAR(last, 1, 1e-9);
  EXPECT_EQ(ticks[0], 17);
  EXPECT_EQ(ticks[2], 16);
}

TEST(EnvSteps, EndAtTheirTimeLimit) {
  EnvConfig config = Rc7Env(ControlMode::kJoints, RelativeTo::kNone);
  config.sim.max_convergence_time = 0.1;
  Env env = Ready(config);
  const EnvStep out = env.Step(ForAll(env, {1.5, 0.5, 0, 1.9, 0, 1.4, 0}));
  EXPECT_EQ(out.reason, EndReason::kTimeout);
  EXPECT_NEAR(out.time, 0.1, 1e-9);
}

TEST(EnvSteps, TakeTheSimulatedTimeWhenPaced) {
  for (const bool async_control : {true, false}) {
    EnvConfig config = Rc7Env();
    config.sim.async_control = async_control;
    config.sim.realtime = true;
    Env env(config);
    const auto start = std::chrono::steady_clock::now();
    env.Reset();
    double simulated = 0, took = 0, least_late = 1;  // seconds
    for (int step = 0; step < 6; ++step) {
      const double began = took, simulated_before = simulated;
      simulated = env.Step(ForAll(env, Numbers(7, 0.02))).time;
      took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      EXPECT_GE(took, simulated);
      least_late = std::min(least_late, (took - began) - (simulated - simulated_before));
    }
    EXPECT_GE(simulated, 0.15);
    EXPECT_LT(least_late, 0.01) << "a busy machine is late at times, and not with every step";
  }
}

// A wall beside the robot, which the robot reaches by turning.
EnvConfig BesideAWall(ModelFolder& folder) {
  EnvConfig config = Rc7Env(ControlMode::kJoints, RelativeTo::kNone);
  config.world_frame_objects["wall"] = {
      .mjcf_path = folder.Write("wall", R"(<worldbody><body name="panel">
        <geom size="0.4 0.02 0.6" type="box"/></body></worldbody>)"),
      .offset = Pose(Eigen::Vector3d(0.4, 0.3, 0.6))};
  return config;
}

TEST(EnvSteps, StopAtACollisionAndContinueFromThere) {
  ModelFolder folder;
  EnvConfig config = BesideAWall(folder);
  Env env = Ready(config);
  const Numbers home = ForAll(env, ObservedJoints(env));
  Numbers turned = home;
  turned[0] = 1.2;
  const EnvStep hit = env.Step(turned);
  ASSERT_EQ(hit.reason, EndReason::kCollision);
  ASSERT_EQ(hit.collisions.size(), 1u);
  EXPECT_EQ(hit.collisions[0].robot, "robot");
  EXPECT_EQ(hit.collisions[0].other_body, "wall_panel");
  EXPECT_EQ(hit.collisions[0].other_robot, "");
  EXPECT_EQ(Describe(hit.collisions[0]),
            "robot 'robot' (" + hit.collisions[0].body + ") touches wall_panel");
  EXPECT_LT(hit.time, 1);
  EXPECT_EQ(env.Step(home).reason, EndReason::kArrived) << "it may leave what it touches";
  EXPECT_THAT(env.Step(home).collisions, IsEmpty());
}

TEST(EnvSteps, ReportCollisionsIfConfigured) {
  ModelFolder folder;
  EnvConfig config = BesideAWall(folder);
  config.sim.on_collision = OnCollision::kReport;
  Env env = Ready(config);
  Numbers turned = ForAll(env, ObservedJoints(env));
  turned[0] = 1.2;
  const EnvStep hit = env.Step(turned);
  EXPECT_EQ(hit.reason, EndReason::kSettled) << "it rests against the wall";
  EXPECT_FALSE(hit.collisions.empty());
}

TEST(EnvSteps, AGuardRevokesAnActionIntoACollision) {
  ModelFolder folder;
  EnvConfig config = BesideAWall(folder);
  config.sim.on_collision = OnCollision::kGuard;
  for (const bool async_control : {false, true}) {
    config.sim.async_control = async_control;
    config.sim.frequency = 2;
    Env env = Ready(config);
    const Numbers home = ObservedJoints(env);
    Numbers turned = ForAll(env, home);
    turned[0] = 1.2;
    for (int i = 0; i < 3; ++i) {
      const EnvStep hit = env.Step(turned);
      EXPECT_EQ(hit.reason, EndReason::kCollision);
      ASSERT_FALSE(hit.collisions.empty());
      EXPECT_EQ(hit.collisions[0].other_body, "wall_panel");
      EXPECT_NEAR(ObservedJoints(env)[0], home[0], 1e-3) << "it stays";
      if (async_control) {
        EXPECT_NEAR(hit.time, 0.5 * (i + 1), 1e-9) << "the time goes on";
      }
    }
    turned[0] = home[0] - 0.2;
    EXPECT_EQ(env.Step(turned).reason, EndReason::kArrived) << "the other way is free";
    EXPECT_NEAR(ObservedJoints(env)[0], home[0] - 0.2, 0.01);
  }
}

TEST(EnvSteps, AGuardChangesNothingWithoutObstacles) {
  const auto run = [](OnCollision on_collision) {
    EnvConfig config = Rc7Env();
    config.sim.on_collision = on_collision;
    Env env = Ready(config);
    Numbers seen;
    for (int i = 0; i < 3; ++i) {
      env.Step(ForAll(env, Numbers(7, 0.02)));
      seen.insert(seen.end(), env.observation().begin(), env.observation().end());
    }
    return seen;
  };
  EXPECT_EQ(run(OnCollision::kGuard), run(OnCollision::kStop));
}

// An arm folded so far that its third link reaches its base; neighbours overlap.
TEST(EnvSteps, LinksConnectedByAJointDoNotCollide) {
  ModelFolder folder;
  RobotConfig arm = ArmConfig(folder.Write("arm", R"(
    <compiler angle="radian" autolimits="true"/>
    <default><joint axis="0 1 0" range="-3 3"/><geom type="capsule"/></default>
    <worldbody><body name="base"><geom type="box" size="0.1 0.1 0.1"/>
      <body name="upper" pos="0 0 0.1"><joint name="shoulder"/><geom size="0.03" fromto="0 0 0 0 0 0.3"/>
        <body name="fore" pos="0 0 0.3"><joint name="elbow"/><geom size="0.03" fromto="0 0 0 0 0 0.4"/>
          <site name="flange" pos="0 0 0.4"/></body></body></body></worldbody>
    <actuator><position name="servo1" joint="shoulder" kp="100" kv="10"/>
      <position name="servo2" joint="elbow" kp="100" kv="10"/></actuator>)"));
  EnvConfig config{.add_floor = false, .relative_to = RelativeTo::kNone};
  config.robots["robot"] = arm;
  Env env = Ready(config);
  EXPECT_THAT(env.Step(Numbers{0.1, 0.1}).collisions, IsEmpty());
  const EnvStep folded = env.Step(Numbers{0, 2.9});
  ASSERT_EQ(folded.reason, EndReason::kCollision);
  EXPECT_THAT(folded.collisions,
              ElementsAre(Collision{"robot", "robotrobot_fore", "robot", "robotrobot_base"}));
}

TEST(EnvSteps, ADivergedSimulationEndsTheEpisode) {
  Env env = Ready(Rc7Env());
  const Numbers still = ForAll(env, Numbers(7, 0));
  env.scene().data()->qvel[0] = 1e12;
  const EnvStep out = env.Step(still);
  EXPECT_EQ(out.reason, EndReason::kDiverged);
  EXPECT_THAT(out.message, ::testing::HasSubstr("diverged at t="));
  ExpectThrow<Error>([&] { (void)env.Step(still); }, "has diverged; call reset to go on");
  env.Reset();
  EXPECT_EQ(env.Step(still).reason, EndReason::kArrived);
}

TEST(EnvResets, FollowTheirSeeds) {
  EnvConfig config = Rc7Env();
  config.robots["robot"].home_noise["arm"] = {0.05};
  const auto episodes = [&](std::optional<uint64_t> seed) {
    Env env(config);
    std::vector<Numbers> seen;
    for (int i = 0; i < 2; ++i) {
      env.Reset({.seed = i == 0 ? seed : std::nullopt});
      env.Step(ForAll(env, Numbers(7, 0.01)));
      seen.emplace_back(env.observation().begin(), env.observation().end());
    }
    return seen;
  };
  const auto first = episodes(5);
  EXPECT_EQ(episodes(5), first);
  EXPECT_NE(first[0], first[1]);
  EXPECT_NE(episodes(6)[0], first[0]);
  EXPECT_EQ(episodes({}), episodes(0));
}

TEST(EnvResets, KeepTheArmsInPlaceIfConfigured) {
  EnvConfig config = Rc7Env();
  config.wrappers.home_on_reset = false;
  Env env = Ready(config);
  const Numbers home = ObservedJoints(env);
  env.Step(ForAll(env, Numbers(7, 0.08)));
  const Numbers moved = ObservedJoints(env);
  env.Reset();
  EXPECT_EQ(ObservedJoints(env), moved);
  EXPECT_NE(moved, home);
  env.Step(ForAll(env, Numbers(7, 0)));
  EXPECT_NEAR(ObservedJoints(env)[0], moved[0], 1e-3) << "and hold still there";
}

TEST(EnvLayouts, ContainObservationsAndDescribeActions) {
  EnvConfig config = Rc7Duo(ControlMode::kCartesianTrpy, RelativeTo::kNone);
  config.sim.async_control = true;
  Env env = Ready(config);
  EXPECT_EQ(env.layout().action.size(), 2 * 7);
  EXPECT_EQ(env.layout().robots[1].command, "xyzrpy");
  Rng rng = Rng::Stream(1, "env layout");
  for (int step = 0; step < 50; ++step) {
    Numbers action;
    for (int i = 0; i < env.layout().action.size(); ++i)
      action.push_back(rng.Uniform(env.layout().action.lower[i], env.layout().action.upper[i]));
    env.Step(action);
    for (int i = 0; i < env.layout().observation.size(); ++i) {
      EXPECT_GE(env.observation()[i], env.layout().observation.lower[i]) << i;
      EXPECT_LE(env.observation()[i], env.layout().observation.upper[i]) << i;
    }
  }
}

TEST(EnvLayouts, RangesMatchTheRobot) {
  const EnvLayout joints = Env(Rc7Env(ControlMode::kJoints, RelativeTo::kNone)).layout();
  const std::vector<Interval> limits =
      Robot::Of(Scene::Build(EnvSceneSpec(Rc7Env())), "robot").joint_limits();
  for (size_t i = 0; i < limits.size(); ++i) {
    EXPECT_EQ(joints.action.lower[i], limits[i].lower);
    EXPECT_EQ(joints.action.upper[i], limits[i].upper);
  }
  EXPECT_NEAR(Env(Rc7Env()).layout().action.upper[0], 5 * internal::kPi / 180, 1e-12);
  const Env cartesian(Rc7Env(ControlMode::kCartesianTquat, RelativeTo::kNone));
  EXPECT_NEAR(cartesian.layout().action.upper[0], Robot::Of(cartesian.scene(), "robot").reach(),
              1e-9);
}

TEST(EnvCopies, OnOneFrozenModelRunInParallelAsSeparately) {
  const EnvConfig config = Rc7Duo(ControlMode::kCartesianTrpy, RelativeTo::kLastStep);
  const std::shared_ptr<CompiledScene> compiled = CompileScene(EnvSceneSpec(config));
  compiled->Freeze();
  const auto run = [&](uint64_t seed, Numbers& seen) {
    Env env(config, Scene::FromCompiled(compiled));
    env.Reset({.seed = seed});
    for (int i = 0; i < 5; ++i) env.Step(ForAll(env, {0.01, 0, 0.01, 0, 0, 0.02}));
    seen.assign(env.observation().begin(), env.observation().end());
  };
  std::vector<Numbers> together(4), alone(4);
  std::vector<std::thread> threads;
  for (uint64_t seed = 0; seed < 4; ++seed)
    threads.emplace_back([&, seed] { run(seed, together[seed]); });
  for (std::thread& thread : threads) thread.join();
  for (uint64_t seed = 0; seed < 4; ++seed) run(seed, alone[seed]);
  EXPECT_EQ(together, alone);
}

}  // namespace
}  // namespace robocell
