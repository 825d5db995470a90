// Tests max_target_lead: how far targets may run ahead of an arm that something blocks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/env/env.h"
#include "robocell/env/env_batch.h"
#include "robocell/env/testing/envs.h"
#include "robocell/env/testing/one_hinge.h"
#include "robocell/math/rotation.h"
#include "robocell/testing/long_form.h"
#include "robocell/testing/menagerie.h"

namespace robocell::internal {
namespace {

using Numbers = std::vector<double>;

double TargetOf(const Env& env) {
  return Robot::Of(env.scene(), "robot").controller("arm").commanded_joint_pos()[0];
}

TEST(EnvTargetLead, LimitsTheLeadOfAJointToOneActionMore) {
  ModelFolder folder;
  EnvConfig config = OneHingeOnABlock(folder);
  for (const double lead : {0.1, 0.05}) {
    if (lead != 0.1) config.max_target_lead = {lead};
    Env env(config);
    env.Reset({.seed = 1});
    for (int i = 0; i < 60; ++i) env.Step(Numbers{0.04});
    const double blocked = env.scene().joint_pos("robotrobot_hip");
    EXPECT_LE(TargetOf(env) - blocked, lead + 0.04 + 0.001) << lead;
    const int back = static_cast<int>(std::ceil((lead + SagOfOneHinge(env)) / 0.04)) + 1;
    for (int i = 0; i < back; ++i) env.Step(Numbers{-0.04});
    EXPECT_LT(env.scene().joint_pos("robotrobot_hip"), blocked - 0.005) << lead;
  }
}

// The lag of a fast arm becomes lead as soon as something stops the arm.
TEST(EnvTargetLead, LimitsTheLeadAfterAFastApproach) {
  ModelFolder folder;
  EnvConfig config = OneHingeOnABlock(folder);
  config.max_relative_movement = {0.2};
  config.sim.async_control = true;
  for (const double frequency : {30.0, 60.0}) {
    config.sim.frequency = frequency;
    for (const double action : {0.05, 0.1, 0.15}) {
      Env env(config);
      env.Reset({.seed = 1});
      for (int i = 0; i < 10; ++i) env.Step(Numbers{-0.1});  // distance to gain speed
      for (int i = 0; i < 60; ++i) env.Step(Numbers{action});
      const double blocked = env.scene().joint_pos("robotrobot_hip");
      EXPECT_LE(TargetOf(env) - blocked, SagOfOneHinge(env) + 0.1 + action + 0.001)
          << frequency << " " << action;
    }
  }
}

// An arm that cannot follow loses part of its target; the motion of the step reports how much.
TEST(EnvTargetLead, ReportsTheDistanceTakenBack) {
  ModelFolder folder;
  Env env(OneHingeOnABlock(folder));
  env.Reset({.seed = 1});
  bool moved = false;
  for (int i = 0; i < 20; ++i) {
    const double before = TargetOf(env);
    env.Step(Numbers{0.04});
    const double taken = env.motions()[0].joint_taken_back;
    EXPECT_NEAR(TargetOf(env), before - taken + 0.04, 1e-12);
    moved = moved || taken > 0.01;
  }
  EXPECT_TRUE(moved);
  env.Step(Numbers{0});
  EXPECT_EQ(env.motions()[0].joint_taken_back, 0);
}

// Many small steps add up to the full distance, however much the arm lags and sags; so do fast
// ones, as long as the lead allows for the arm's start.
TEST(EnvTargetLead, RampsReachTheirEnd) {
  for (const bool sagging : {true, false}) {
    for (const double step : {-0.0005, -0.02}) {
      ModelFolder folder;
      EnvConfig config = sagging ? OneHinge(folder) : Rc7Env();
      // A slow ramp: each step is smaller than the hinge's sag.
      if (step > -0.01) config.max_target_lead = {0.02};
      config.sim.async_control = true;
      config.sim.frequency = 50;
      Env env(config);
      env.Reset({.seed = 1});
      const double start = TargetOf(env);
      Numbers action(static_cast<size_t>(env.layout().action.size()), 0);
      for (int i = 0; i < 50; ++i) env.Step(action);  // until gravity and servo balance
      action[0] = step;
      const int steps = static_cast<int>(std::lround(0.4 / -step));
      for (int i = 0; i < steps; ++i) env.Step(action);
      EXPECT_NEAR(TargetOf(env), start - 0.4, 1e-9) << sagging << " " << step;
    }
  }
}

TEST(EnvTargetLead, AZeroActionKeepsTheTargetOfABlockedArm) {
  ModelFolder folder;
  Env env(OneHingeOnABlock(folder));
  env.Reset({.seed = 1});
  for (int i = 0; i < 10; ++i) env.Step(Numbers{0.08});
  const double target = TargetOf(env);
  for (int i = 0; i < 10; ++i) env.Step(Numbers{0});
  EXPECT_EQ(TargetOf(env), target);
}

// Only the blocked direction is taken back: the tool keeps its orientation and its place.
TEST(EnvTargetLead, PressingDoesNotTurnATool) {
  EnvConfig config = Rc7Env(ControlMode::kCartesianTrpy);
  config.add_floor = true;
  config.sim.on_collision = OnCollision::kReport;
  Env env(config);
  env.Reset({.seed = 1});
  const Robot robot = Robot::Of(env.scene(), "robot");
  const auto target = [&] { return robot.FkFrame(robot.controller("arm").commanded_joint_pos()); };
  const Pose before = target();
  Numbers down(7, 0);
  down[2] = -0.02;
  for (int i = 0; i < 60; ++i) {
    if (!env.Step(down).ik_failed.empty()) break;
    if (env.motions()[0].position_shortfall > 0) break;
    EXPECT_NEAR(target().translation().x(), before.translation().x(), 1e-3) << i;
    EXPECT_NEAR(target().translation().y(), before.translation().y(), 1e-3) << i;
    EXPECT_LT(AngleBetween(target().quaternion(), before.quaternion()), 1e-3) << i;
  }
}

// Earlier commands do not delay a blocked arm that leaves, whatever actions are relative to.
TEST(EnvTargetLead, AbsoluteActionsRetreatAtOnce) {
  ModelFolder folder;
  EnvConfig config = OneHingeOnABlock(folder);
  config.max_relative_movement = {0.05};
  for (const RelativeTo relative_to : {RelativeTo::kNone, RelativeTo::kConfiguredOrigin}) {
    config.relative_to = relative_to;
    Env env(config);
    env.Reset({.seed = 1});
    for (int i = 0; i < 30; ++i) env.Step(Numbers{1.5});
    const double blocked = env.scene().joint_pos("robotrobot_hip");
    EXPECT_LE(TargetOf(env) - blocked, 0.1 + 0.05 + 0.001);
    for (int i = 0; i < 5; ++i) env.Step(Numbers{-0.5});
    EXPECT_LT(env.scene().joint_pos("robotrobot_hip"), blocked - 0.01);
  }
}

// Presses one robot with an open hand onto the floor by actions of 2 cm. Returns how far the TCP
// has risen after each of five actions of 2 cm up. `ahead` receives the distance of the target
// below the TCP.
Numbers RiseAfterPushing(EnvConfig config, bool batched, int pushes, double* ahead = nullptr) {
  config.add_floor = true;
  config.control_mode = ControlMode::kCartesianTquat;
  config.relative_to = RelativeTo::kLastStep;
  config.sim.on_collision = OnCollision::kReport;
  config.task = {};
  config.cameras.streams.clear();
  EnvBatch batch(config, batched ? 2 : 1);
  batch.Reset({});
  const auto n = static_cast<size_t>(batch.layout().action.size());
  const auto tcp_z = [&] {
    const VectorPart& part = batch.layout().robots[0].tquat;
    return batch.observations()[static_cast<size_t>(part.begin) + 2];
  };
  const auto move = [&](double z) {
    Numbers actions(n * static_cast<size_t>(batch.size()), 0);
    for (int i = 0; i < batch.size(); ++i) {
      const size_t first = n * static_cast<size_t>(i);
      actions[first + 2] = z;
      actions[first + 6] = 1;
      if (n > 7) actions[first + 7] = 1;
    }
    batch.Step(actions);
  };
  for (int i = 0; i < pushes; ++i) move(-0.02);
  Numbers rise;
  const double pressed = tcp_z();
  if (ahead) {
    const Robot robot = Robot::Of(batch.env(0).scene(), batch.layout().robots[0].robot);
    const Pose target = batch.env(0).scene().shared_base_frame_to_world().inverse() *
                        robot.base_in_world() *
                        robot.FkFrame(robot.controller("arm").commanded_joint_pos());
    *ahead = pressed - target.translation().z();
  }
  for (int i = 0; i < 5; ++i) {
    move(0.02);
    rise.push_back(tcp_z() - pressed);
  }
  return rise;
}

using Variants = std::vector<bool>;

// The built-in arm tries both variants of a test, other arms in the short form the first.
Variants Both(bool first) { return {first, !first}; }
Variants BothInTheLongForm(bool first) { return LongForm() ? Both(first) : Variants{first}; }

// An arm lags behind its target also where nothing blocks it, so the reference is the same arm,
// free and at rest.
void ExpectToRiseAtOnce(const EnvConfig& config, const Variants& batches) {
  for (const bool batched : batches) {
    const Numbers free = RiseAfterPushing(config, batched, 0);
    const Numbers rise = RiseAfterPushing(config, batched, 60);
    for (size_t i = 0; i < rise.size(); ++i)
      EXPECT_GT(rise[i], free[i] - 0.005)
          << ::testing::PrintToString(rise) << " " << ::testing::PrintToString(free);
  }
}

// At 30 actions a second arms are fast when they reach the floor.
void ExpectToBeLedLittle(EnvConfig config, const Variants& batches) {
  config.sim.async_control = true;
  config.sim.frequency = 30;
  for (const bool batched : batches) {
    double ahead = 0;
    const Numbers rise = RiseAfterPushing(config, batched, 80, &ahead);
    EXPECT_LT(ahead, 0.02 + 0.02 + 0.001) << batched;
    EXPECT_GT(rise[2], 0.005) << ::testing::PrintToString(rise);
  }
}

TEST(EnvTargetLead, ABuiltInArmHasASmallLeadAfterAFastApproach) {
  ExpectToBeLedLittle(Rc7Env(), Both(false));
}

TEST(EnvTargetLead, AnFr3HasASmallLeadAfterAFastApproach) {
  REQUIRE_MENAGERIE("franka_fr3");
  ExpectToBeLedLittle(EnvConfig::Load(assets::BuiltinCellFile("fr3")), BothInTheLongForm(true));
}

TEST(EnvTargetLead, ABuiltInArmRisesAtOnceFromTheFloor) {
  ExpectToRiseAtOnce(Rc7Env(), Both(false));
}

TEST(EnvTargetLead, AnFr3RisesAtOnceFromTheFloor) {
  REQUIRE_MENAGERIE("franka_fr3");
  ExpectToRiseAtOnce(EnvConfig::Load(assets::BuiltinCellFile("fr3")), BothInTheLongForm(true));
}

// A blocked link holds its joints back, while the TCP still moves by the others.
struct BlockedLink {
  Eigen::Vector3d box, push;
};

// Pushes `pushes` times; returns the largest lead of a joint, rad, and how far the first action
// back moves the TCP, m.
std::pair<double, double> PushLinkAgainstABox(EnvConfig config, const BlockedLink& blocked,
                                              int pushes) {
  config.root_frame_objects["box"] = {.offset = Pose(blocked.box),
                                      .fixed = true,
                                      .shape = Shape::kBox,
                                      .size = Vec3{0.1, 0.1, 0.3},
                                      .mass = 1};
  config.control_mode = ControlMode::kCartesianTrpy;
  config.relative_to = RelativeTo::kLastStep;
  config.sim.on_collision = OnCollision::kReport;
  config.task = {};
  config.cameras.streams.clear();
  Env env(config);
  env.Reset({.seed = 10});
  const Robot robot = Robot::Of(env.scene(), env.layout().robots[0].robot);
  const auto move = [&](const Eigen::Vector3d& displacement) {
    Numbers action(7, 0);
    std::copy_n(displacement.data(), 3, action.begin());
    action[6] = 1;
    env.Step(action);
  };
  for (int i = 0; i < pushes; ++i) move(blocked.push);
  double most = 0;
  const Numbers q = robot.arm().joint_pos();
  const std::span<const double> sent = robot.controller("arm").commanded_joint_pos();
  for (size_t i = 0; i < q.size(); ++i) most = std::max(most, std::abs(sent[i] - q[i]));
  const Pose pressed = robot.tcp_in_world();
  move(-blocked.push);
  const Eigen::Vector3d displacement = robot.tcp_in_world().translation() - pressed.translation();
  return {most, -displacement.dot(blocked.push.normalized())};
}

// The lead of joints is three times that of poses, 0.3 rad, and one action.
void ExpectJointsToBeLedLittle(EnvConfig config, const BlockedLink& blocked,
                               const Variants& asyncs) {
  for (const bool async : asyncs) {
    config.sim.async_control = async;
    config.sim.frequency = 30;
    const double free = PushLinkAgainstABox(config, blocked, 0).second;
    const auto [lead, back] = PushLinkAgainstABox(config, blocked, 60);
    EXPECT_LT(lead, 0.3 + 0.1) << async;
    EXPECT_GT(back, free - 0.005) << async;
    EXPECT_GT(back, 0.003) << async;
  }
}

const BlockedLink kShoulderBehind = {{-0.35, 0.1, 0.3}, {-0.0129, 0.0061, -0.0141}};

TEST(EnvTargetLead, ABlockedBuiltInArmHasASmallLead) {
  ExpectJointsToBeLedLittle(Rc7Env(), {{0.3, 0.3, 0.3}, {-0.0099, 0.0028, 0.0172}}, Both(true));
}

TEST(EnvTargetLead, ABlockedFr3HasASmallLead) {
  REQUIRE_MENAGERIE("franka_fr3");
  ExpectJointsToBeLedLittle(EnvConfig::Load(assets::BuiltinCellFile("fr3")), kShoulderBehind,
                            BothInTheLongForm(true));
}

TEST(EnvTargetLead, ABlockedGen3HasASmallLead) {
  REQUIRE_MENAGERIE("kinova_gen3", "robotiq_2f85");
  ExpectJointsToBeLedLittle(EnvConfig::Load(assets::BuiltinCellFile("gen3_2f85")), kShoulderBehind,
                            BothInTheLongForm(true));
}

// At 30 actions a second its light wrist has to follow at its force limit.
TEST(EnvTargetLead, AGen3FollowsFreelyWithoutSwinging) {
  REQUIRE_MENAGERIE("kinova_gen3", "robotiq_2f85");
  EnvConfig config = EnvConfig::Load(assets::BuiltinCellFile("gen3_2f85"));
  config.relative_to = RelativeTo::kLastStep;
  config.max_relative_movement = {};
  config.sim.on_collision = OnCollision::kReport;
  Env env(config);
  env.Reset({.seed = 0});
  const Robot robot = Robot::Of(env.scene(), env.layout().robots[0].robot);
  double lead = 0, speed = 0;
  for (int i = 0; i < 60; ++i) {
    env.Step(Numbers{0.02, 0, 0, 0, 0, 0, 1, 1});
    const Numbers q = robot.arm().joint_pos(), qd = robot.arm().joint_vel();
    const std::span<const double> sent = robot.controller("arm").commanded_joint_pos();
    for (size_t j = 0; j < q.size(); ++j) {
      lead = std::max(lead, std::abs(sent[j] - q[j]));
      speed = std::max(speed, std::abs(qd[j]));
    }
  }
  EXPECT_LT(lead, 0.35);
  EXPECT_LT(speed, 8);
}

TEST(EnvTargetLead, ABlockedPandaHasASmallLead) {
  REQUIRE_MENAGERIE("franka_emika_panda");
  ExpectJointsToBeLedLittle(EnvConfig::Load(assets::BuiltinCellFile("panda")), kShoulderBehind,
                            BothInTheLongForm(true));
}

}  // namespace
}  // namespace robocell::internal
