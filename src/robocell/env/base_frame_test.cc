// Tests environments whose robots have joints below their base.
#include "robocell/env/base_frame.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/base/files.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/env.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

// A chassis on a rail and a turntable that carries an arm of six joints.
class BaseFrame : public ::testing::Test {
 protected:
  std::string Model(const std::string& rail_range) {
    std::string arm, ends;
    const char* axes[] = {"0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1"};
    const double lengths[] = {0.1, 0.3, 0.25, 0.1, 0.08, 0.05};
    std::string servos = R"(<position name="rail" joint="rail" kp="20000" kv="2000"/>
      <position name="turn" joint="turn" kp="5000" kv="500"/>)";
    for (int i = 0; i < 6; ++i) {
      arm += fmt::format(
          R"(<body name="l{0}" pos="0 0 {1}"><joint name="j{0}" axis="{2}" range="-2.8 2.8"/>
             <geom size="0.03" fromto="0 0 0 0 0 {3}" type="capsule" mass="1"/>)",
          i + 1, i == 0 ? 0.1 : lengths[i - 1], axes[i], lengths[i]);
      servos += fmt::format(R"(<position name="s{0}" joint="j{0}" kp="2000" kv="200"/>)", i + 1);
      ends += "</body>";
    }
    return folder.Write("rover", fmt::format(R"(<compiler angle="radian" autolimits="true"/>
      <option integrator="implicitfast"/>
      <default><geom contype="0" conaffinity="0"/><joint damping="1" armature="0.1"/></default>
      <worldbody><body name="chassis"><joint name="rail" type="slide" axis="1 0 0" {}/>
        <joint name="turn" axis="0 0 1" range="-3 3"/><geom type="box" size="0.2 0.2 0.05" mass="20"/>
        {}<site name="tip" pos="0 0 0.05"/>{}</body></worldbody><actuator>{}</actuator>
      <keyframe><key name="home" qpos="0 0 0 0.4 1.2 0 0.8 0"/>
        <key name="parked" qpos="0.7 1.2 0 0.4 1.2 0 0.8 0"/></keyframe>)",
                                             rail_range, arm, ends, servos));
  }
  EnvConfig Config(RelativeTo relative_to, const std::string& rail_range = "range='-1 1'") {
    const std::string file = (folder.path() / "rover.yaml").string();
    AtomicWrite(file, "name: rover\nmodel: " + Model(rail_range) + R"(
root_body: chassis
move_groups:
  arm: {kind: arm, joints: j1..j6, leaf: {site: tip}}
  drive: {kind: generic, joints: [rail, turn], actuators: [rail, turn]}
gravcomp: true
)");
    EnvConfig config;
    config.robots["r"] = RobotConfig::Load(file);
    config.control_mode = ControlMode::kCartesianTquat;
    config.relative_to = relative_to;
    return config;
  }
  Pose Observed(const Env& env) {
    const VectorPart& part = env.layout().robots[0].tquat;
    return internal::PoseOfAction(ControlMode::kCartesianTquat,
                                  std::span(env.observation()).subspan(part.begin, part.size));
  }
  static std::vector<double> Tquat(const Pose& pose) {
    std::vector<double> out(pose.translation().begin(), pose.translation().end());
    out.insert(out.end(), pose.quaternion().begin(), pose.quaternion().end());
    return out;
  }

  ModelFolder folder;
};

TEST_F(BaseFrame, RelativeActionsKeepTheirDirectionWhereJointsMovedTheBase) {
  Env env(Config(RelativeTo::kLastStep));
  env.Reset({.keyframe = "r: parked"});
  const Pose before = Observed(env);
  EXPECT_NEAR(before.translation().x(), 0.7 + std::cos(1.2) * 0.4, 0.2) << "it stands elsewhere";
  env.Step(Tquat(Pose({0.03, 0, 0})));
  const Eigen::Vector3d moved = Observed(env).translation() - before.translation();
  EXPECT_LT((moved - Eigen::Vector3d(0.03, 0, 0)).norm(), 0.003) << moved.transpose();
}

TEST_F(BaseFrame, CommandingTheObservedPoseMovesNothing) {
  Env env(Config(RelativeTo::kNone));
  env.Reset({.keyframe = "r: parked"});
  const Pose before = Observed(env);
  EXPECT_TRUE(env.Step(Tquat(before)).ik_failed.empty());
  EXPECT_TRUE(Observed(env).is_close(before, 0.01, 0.002));
}

TEST_F(BaseFrame, AStateKeepsTheTargetsOfTheJointsBelowTheBase) {
  const EnvConfig config = Config(RelativeTo::kLastStep);
  Env first(config), second(config);
  first.Reset({.keyframe = "r: parked"});
  const EnvState state = first.state();
  second.Reset();
  second.SetState(state);
  for (Env* env : {&first, &second}) {
    for (int step = 0; step < 3; ++step) env->Step(Tquat(Pose({0.01, 0, 0})));
  }
  for (int i = 0; i < first.scene().model()->nq; ++i)
    EXPECT_EQ(first.scene().data()->qpos[i], second.scene().data()->qpos[i]) << i;
  EXPECT_NEAR(second.scene().data()->qpos[0], 0.7, 0.02) << "the rail";
}

TEST_F(BaseFrame, CommandsByNameMoveTheJointsBelowTheBase) {
  Env env(Config(RelativeTo::kLastStep));
  env.Reset();
  env.Act({{"robots/r/action/drive", {0.2, 0.3}}});
  env.Act({{"robots/r/action/arm_relative", {0.1, 0, 0, 0, 0, 0}}});
  EXPECT_NEAR(env.scene().data()->qpos[0], 0.2, 0.01) << "the rail keeps its target";
  EXPECT_NEAR(env.scene().data()->qpos[1], 0.3, 0.01);
}

TEST_F(BaseFrame, RangesHoldAtAnyBasePose) {
  Env env(Config(RelativeTo::kNone));
  env.Reset({.keyframe = "r: parked"});
  const VectorPart& part = env.layout().robots[0].tquat;
  const VectorRange& range = env.layout().observation;
  for (int i = part.begin; i < part.begin + part.size; ++i) {
    EXPECT_GE(env.observation()[i], range.lower[i]);
    EXPECT_LE(env.observation()[i], range.upper[i]);
  }
  EXPECT_TRUE(std::isfinite(range.upper[part.begin]));
  const Env endless(Config(RelativeTo::kNone, ""));
  EXPECT_TRUE(std::isinf(endless.layout().observation.upper[part.begin]));
}

}  // namespace
}  // namespace robocell
