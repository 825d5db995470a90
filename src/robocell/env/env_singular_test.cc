// Tests relative Cartesian actions beside singularities: damped steps, and how far they get.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robocell/env/arm_target.h"
#include "robocell/env/env.h"
#include "robocell/env/env_batch.h"
#include "robocell/env/testing/envs.h"
#include "robocell/env/testing/one_hinge.h"
#include "robocell/kinematics/ik_step.h"
#include "robocell/math/rotation.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Numbers = std::vector<double>;

// Six joints in the order and lengths of common small arms: waist, shoulder, elbow, forearm roll,
// wrist, hand roll. The two rolls are parallel when the wrist is straight.
EnvConfig SmallArm(ModelFolder& folder, double wrist) {
  RobotConfig robot{.name = "small", .model = folder.Write("small", R"(
    <compiler angle="radian" autolimits="true"/>
    <default><joint range="-2.5 2.5" damping="1" armature="0.05"/><geom size="0.02" mass="0.2"/>
      <position kp="400" kv="40"/></default>
    <worldbody><body name="base"><geom/>
      <body name="a" pos="0 0 0.08"><joint name="waist" axis="0 0 1"/><geom/>
       <body name="b" pos="0 0 0.048"><joint name="shoulder" axis="0 1 0"/><geom/>
        <body name="c" pos="0.06 0 0.3"><joint name="elbow" axis="0 1 0"/><geom/>
         <body name="d" pos="0.2 0 0"><joint name="roll" axis="1 0 0"/><geom/>
          <body name="e" pos="0.1 0 0"><joint name="wrist" axis="0 1 0"/><geom/>
           <body name="f" pos="0.07 0 0"><joint name="hand" axis="1 0 0"/><geom/>
            <site name="tip" pos="0.1 0 0"/>
    </body></body></body></body></body></body></body></worldbody>
    <actuator><position name="waist" joint="waist"/><position name="shoulder" joint="shoulder"/>
      <position name="elbow" joint="elbow"/><position name="roll" joint="roll"/>
      <position name="wrist" joint="wrist"/><position name="hand" joint="hand"/></actuator>
    <contact><exclude body1="base" body2="b"/></contact>)")};
  robot.gravcomp = true;
  const std::vector<std::string> names = {"waist", "shoulder", "elbow", "roll", "wrist", "hand"};
  robot.move_groups["arm"] = {.kind = MoveGroupKind::kArm,
                              .joints = names,
                              .actuators = names,
                              .leaf = ElementRef{.kind = ElementKind::kSite, .name = "tip"}};
  robot.home["arm"] = {0, -0.96, 1.16, 0, wrist, 0};
  EnvConfig config;
  config.robots["robot"] = robot;
  config.control_mode = ControlMode::kCartesianTrpy;
  config.sim.on_collision = OnCollision::kReport;
  return config;
}

Numbers RandomAction(Rng& rng) {
  Numbers action(6);
  for (int i = 0; i < 6; ++i) action[i] = rng.Uniform(-1, 1) * (i < 3 ? 0.015 : 0.05);
  return action;
}

Pose TargetPose(const Env& env) {
  const Robot robot = Robot::Of(env.scene(), "robot");
  return robot.FkFrame(robot.controller("arm").commanded_joint_pos());
}

TEST(EnvSingular, SmallActionsNearASingularityContinue) {
  for (const double wrist : {-0.05, 0.0}) {
    ModelFolder folder;
    Env env(SmallArm(folder, wrist));
    env.Reset({.seed = 1});
    const Robot robot = Robot::Of(env.scene(), "robot");
    Rng rng = Rng::Stream(5, "singular");
    int damped = 0;
    for (int step = 0; step < 60; ++step) {
      const Numbers action = RandomAction(rng);
      const auto before = robot.controller("arm").commanded_joint_pos();
      const Numbers from(before.begin(), before.end());
      const Pose commanded = internal::MovedBy(
          TargetPose(env), internal::PoseOfAction(ControlMode::kCartesianTrpy, action));
      const double most = internal::LargestJointStep(robot.chain(), TargetPose(env), commanded);
      EXPECT_THAT(env.Step(action).ik_failed, IsEmpty()) << wrist << " " << step;
      const auto after = robot.controller("arm").commanded_joint_pos();
      for (size_t i = 0; i < from.size(); ++i)
        EXPECT_LE(std::abs(after[i] - from[i]), most + 1e-6) << wrist << " " << step;
      const ArmMotion& motion = env.motions()[0];
      const Pose reached = TargetPose(env);
      EXPECT_NEAR(motion.position_shortfall,
                  (commanded.translation() - reached.translation()).norm(), 1e-4);
      EXPECT_NEAR(motion.rotation_shortfall,
                  AngleBetween(commanded.quaternion(), reached.quaternion()), 1e-4);
      damped += motion.position_shortfall > 0;
    }
    EXPECT_GT(damped, 0) << wrist << ": the test has to meet the singularity";
    EXPECT_LT(damped, 40) << wrist;
  }
}

TEST(EnvSingular, ActionsInADirectionWithoutMotionFail) {
  ModelFolder folder;
  EnvConfig config = OneHinge(folder);
  config.control_mode = ControlMode::kCartesianTrpy;
  EnvBatch batch(config, 2);
  batch.Reset({});
  const Pose before = TargetPose(batch.env(0));
  Numbers actions(12, 0);
  actions[0] = 0.01;       // away from the hinge
  actions[6 + 2] = -0.01;  // down
  const BatchStep& step = batch.Step(actions);
  EXPECT_EQ(step.steps[0].reason, EndReason::kIkFailed);
  EXPECT_THAT(step.steps[0].ik_failed, ElementsAre("robot"));
  EXPECT_TRUE(TargetPose(batch.env(0)).is_close(before, 1e-9, 1e-9));
  EXPECT_FALSE(batch.ik_success(0, 0));
  EXPECT_TRUE(batch.ik_success(1, 0)) << "it goes down, though it cannot keep its direction";
  EXPECT_LT(TargetPose(batch.env(1)).translation().z(), before.translation().z() - 1e-3);
  EXPECT_GT(batch.env(1).motions()[0].rotation_shortfall, 0);
}

}  // namespace
}  // namespace robocell
