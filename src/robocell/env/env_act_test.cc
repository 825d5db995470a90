// Tests commands by the names of features: what datasets record acts in an environment.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/env.h"
#include "robocell/env/env_observer.h"
#include "robocell/env/testing/envs.h"
#include "robocell/features/cell_features.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/long_form.h"

namespace robocell {
namespace {

using Commands = std::map<std::string, std::vector<double>>;

constexpr const char* kArm = "robots/robot/action/arm";
constexpr const char* kGripper = "robots/robot/action/gripper";

std::vector<double> Seen(const Env& env) {
  return {env.observation().begin(), env.observation().end()};
}

std::vector<double> TargetOfArm(const Env& env) {
  const Robot robot = Robot::Of(env.scene(), "robot");
  const auto target = robot.controller("arm").commanded_joint_pos();
  return {target.begin(), target.end()};
}

// Returns what an episode records of the last action: the absolute target of each group.
Commands RecordedTargets(Env& env) {
  Commands targets;
  std::span<const double> rest = env.features().ReadActions();
  for (const Feature& feature : env.features().commanded().features()) {
    const auto size = static_cast<size_t>(feature.size());
    if (env.features().commanded().Has(feature.column.name + "_relative"))
      targets[feature.column.name].assign(rest.begin(), rest.begin() + feature.size());
    rest = rest.subspan(size);
  }
  return targets;
}

std::vector<double> RandomAction(const Env& env, Rng& rng) {
  const VectorRange& range = env.layout().action;
  std::vector<double> action;
  for (int i = 0; i < range.size(); ++i) {
    const double most = std::min(0.05, range.upper[i] - range.lower[i]);
    action.push_back(rng.Uniform(-most, most));
  }
  for (const RobotLayout& robot : env.layout().robots) {
    if (robot.has_gripper) action[robot.gripper_action] = rng.Uniform(0, 1);
    if (robot.command == "tquat") action[robot.action.begin + 6] = 1;
  }
  return action;
}

TEST(EnvAct, RecordedTargetsGiveTheStatesAgainToTheBit) {
  for (const ControlMode mode :
       {ControlMode::kJoints, ControlMode::kCartesianTrpy, ControlMode::kCartesianTquat}) {
    for (const RelativeTo relative_to : {RelativeTo::kLastStep, RelativeTo::kConfiguredOrigin}) {
      for (const bool is_binary : {true, false}) {
        // The short form tries each value with each other one, the long form all combinations.
        if (!LongForm() && is_binary != (relative_to == RelativeTo::kLastStep)) continue;
        EnvConfig config = Rc7Duo(mode, relative_to);
        config.wrappers.binary_gripper = is_binary;
        config.robots["right"].control["arm"] = ControlKind::kRelativeJointPosition;
        config.sim.async_control = mode == ControlMode::kJoints;
        Env env(config), other(config);
        env.Reset({.seed = 3});
        other.Reset({.seed = 3});
        Rng rng = Rng::Stream(5, "commands by name", static_cast<int>(mode));
        for (int step = 0; step < 6; ++step) {
          env.features().ReadState();
          const EnvStep own = env.Step(RandomAction(env, rng));
          const EnvStep named = other.Act(RecordedTargets(env));
          ASSERT_EQ(Seen(other), Seen(env)) << ToString(mode) << " step " << step;
          EXPECT_EQ(named.time, own.time);
        }
      }
    }
  }
}

TEST(EnvAct, AGroupWithoutACommandKeepsItsTarget) {
  Env env(Rc7Env());
  env.Reset();
  const std::vector<double> home = TargetOfArm(env);
  env.Act({{kGripper, {0}}});
  EXPECT_EQ(TargetOfArm(env), home);
  EXPECT_EQ(env.observation()[env.layout().robots[0].gripper], 0);
  env.Act({{kGripper, {0.7}}});
  EXPECT_EQ(Robot::Of(env.scene(), "robot").controller("gripper").target()[0], 0.7);
  EXPECT_EQ(env.observation()[env.layout().robots[0].gripper], 1) << "binary_gripper";
  env.Act({{kGripper, {0}}});
  std::vector<double> there = home;
  there[1] += 0.3;
  env.Act({{kArm, there}});
  EXPECT_EQ(TargetOfArm(env), there) << "more than max_relative_movement";
  EXPECT_EQ(env.observation()[env.layout().robots[0].gripper], 0);
}

TEST(EnvAct, AnActionOfTheEnvironmentContinuesFromTheCommand) {
  for (const ControlMode mode : {ControlMode::kJoints, ControlMode::kCartesianTquat}) {
    Env env(Rc7Env(mode));
    env.Reset();
    std::vector<double> there = TargetOfArm(env);
    there[1] += 0.2;
    ASSERT_EQ(env.Act({{kArm, there}}).reason, EndReason::kArrived);
    const Robot robot = Robot::Of(env.scene(), "robot");
    const Pose sent = robot.FkFrame(there);
    std::vector<double> action(static_cast<size_t>(env.layout().action.size()));
    action[0] = 0.02;
    action.back() = 1;
    if (mode == ControlMode::kCartesianTquat) action[6] = 1;
    env.Step(action);
    if (mode == ControlMode::kJoints) {
      there[0] += 0.02;
      EXPECT_EQ(TargetOfArm(env), there);
    } else {
      const Pose wanted = internal::MovedBy(sent, Pose(Eigen::Vector3d(0.02, 0, 0)));
      EXPECT_TRUE(robot.FkFrame(TargetOfArm(env)).is_close(wanted, 3e-5, 3e-5));
    }
  }
}

TEST(EnvAct, RelativeCommandsAndPosesActAsInRuns) {
  Env env(Rc7Env());
  env.Reset();
  std::vector<double> wanted = TargetOfArm(env);
  wanted[0] += 0.1;
  env.Act({{"robots/robot/action/arm_relative", {0.1, 0, 0, 0, 0, 0, 0}}});
  EXPECT_EQ(TargetOfArm(env), wanted);
  const Robot robot = Robot::Of(env.scene(), "robot");
  const Pose up = robot.arm().leaf_frame_to_robot();
  const EnvStep step = env.Act({{"robots/robot/action/tcp_displacement", {0, 0, 0.03, 0, 0, 0}}});
  EXPECT_THAT(step.ik_failed, ::testing::IsEmpty());
  EXPECT_NEAR(robot.FkFrame(TargetOfArm(env)).translation().z(), up.translation().z() + 0.03, 1e-4);
  const std::vector<double> before = TargetOfArm(env);
  EXPECT_EQ(env.Act({{"robots/robot/action/tcp_pose", {5, 0, 0, 0, 0, 0, 1}}}).reason,
            EndReason::kIkFailed);
  EXPECT_EQ(TargetOfArm(env), before);
}

TEST(EnvAct, RejectsCommandsBeforeAnythingMoves) {
  Env env(Rc7Env());
  ExpectThrow<Error>([&] { env.Act({}); }, "call reset before the first step");
  env.Reset({.seed = 1});
  const std::vector<double> state = env.state().numbers();
  const std::vector<double> q = TargetOfArm(env);
  ExpectThrow<NotFoundError>(
      [&] {
        env.Act({{"robots/robot/action/amr", q}});
      },
      "Did you mean 'robots/robot/action/arm'?");
  ExpectThrow<ArgumentError>(
      [&] {
        env.Act({{kArm, q}, {"robots/robot/action/arm_relative", q}});
      },
      "both move group 'arm'");
  ExpectThrow<ArgumentError>([&] { env.Act({{kArm, {1, 2}}}); }, "has 7 numbers, got 2");
  ExpectThrow<ArgumentError>([&] { env.Act({{kGripper, {NAN}}}); }, "is not finite");
  EXPECT_EQ(env.state().numbers(), state);
  EXPECT_EQ(env.Act({{kArm, q}}).reason, EndReason::kArrived);
}

TEST(EnvAct, NotifiesObserversOfCommands) {
  struct Listener : EnvObserver {
    void OnAction(std::span<const double>) override { ++actions; }
    void OnCommands(const Action& commands) override {
      robots += static_cast<int>(commands.size());
    }
    int actions = 0, robots = 0;
  } listener;
  Env env(Rc7Env());
  env.Reset();
  env.AddObserver(&listener);
  env.Act({{kGripper, {0}}});
  EXPECT_EQ(listener.actions, 0);
  EXPECT_EQ(listener.robots, 1);
  env.RemoveObserver(&listener);
}

TEST(EnvResets, AMisspeltKeyframeChangesNothing) {
  Env env(Rc7Env()), same(Rc7Env());
  env.Reset({.seed = 1});
  same.Reset({.seed = 1});
  const std::vector<double> state = env.state().numbers();
  ExpectThrow<NotFoundError>([&] { env.Reset({.seed = 9, .keyframe = "hoem"}); },
                             "no keyframe 'hoem'");
  ExpectThrow<ArgumentError>([&] { env.Reset({.keyframe = 99}); }, "there is no keyframe 99");
  ExpectThrow<NotFoundError>(
      [&] {
        env.Reset({.keyframe = PartKeyframes{{"rbot", "home"}}});
      },
      "Did you mean 'robot'?");
  EXPECT_EQ(env.state().numbers(), state);
  const std::vector<double> still(static_cast<size_t>(env.layout().action.size()));
  EXPECT_EQ(env.Step(still).reason, same.Step(still).reason);
  env.Reset();
  same.Reset();
  EXPECT_EQ(Seen(env), Seen(same)) << "the stream of seeds is that of seed 1";
}

// The target that later actions start from and that episodes record is the one the arm is driven to.
TEST(EnvAct, ATargetBeyondALimitBecomesTheNearestInside) {
  for (const ControlKind control :
       {ControlKind::kJointPosition, ControlKind::kRelativeJointPosition}) {
    EnvConfig config = Rc7Env(ControlMode::kJoints, RelativeTo::kLastStep);
    config.robots["robot"].control["arm"] = control;
    Env env(config);
    env.Reset();
    const double upper = Robot::Of(env.scene(), "robot").chain().joints()[0].upper;
    std::vector<double> target = TargetOfArm(env);
    target[0] = 9;
    ASSERT_GT(target[0], upper);
    env.Act({{kArm, target}});
    EXPECT_NEAR(TargetOfArm(env)[0], upper, 1e-9);
    EXPECT_NEAR(RecordedTargets(env)[kArm][0], upper, 1e-9);
    env.Step(std::vector<double>(static_cast<size_t>(env.layout().action.size())));
    EXPECT_NEAR(TargetOfArm(env)[0], upper, 1e-9);
    env.Act({{"robots/robot/action/arm_relative", {5, 0, 0, 0, 0, 0, 0}}, {kGripper, {7}}});
    EXPECT_NEAR(TargetOfArm(env)[0], upper, 1e-9);
    EXPECT_EQ(RecordedTargets(env)[kGripper][0], 1);
  }
}

TEST(EnvAct, AnAbsoluteActionBeyondALimitBecomesTheNearestInside) {
  Env env(Rc7Env(ControlMode::kJoints, RelativeTo::kNone));
  env.Reset();
  const double upper = Robot::Of(env.scene(), "robot").chain().joints()[0].upper;
  std::vector<double> action(static_cast<size_t>(env.layout().action.size()));
  action[0] = 9;
  env.Step(action);
  EXPECT_NEAR(TargetOfArm(env)[0], upper, 1e-9);
}

// A pose out of reach keeps the last target, from which later actions start.
TEST(EnvAct, APoseOutOfReachKeepsTheTarget) {
  Env env(Rc7Env(ControlMode::kJoints, RelativeTo::kLastStep));
  env.Reset();
  const std::vector<double> before = TargetOfArm(env);
  env.Act({{"robots/robot/action/tcp_pose", {9, 0, 0, 0, 0, 0, 1}}});
  EXPECT_EQ(TargetOfArm(env), before);
  env.Step(std::vector<double>(static_cast<size_t>(env.layout().action.size())));
  EXPECT_EQ(TargetOfArm(env), before);
}

}  // namespace
}  // namespace robocell
