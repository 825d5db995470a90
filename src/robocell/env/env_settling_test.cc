// Tests steps that end away from their target: servos that sag, arms that carry a load or are
// blocked.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/env/env.h"
#include "robocell/env/env_batch.h"
#include "robocell/env/testing/envs.h"
#include "robocell/env/testing/one_hinge.h"
#include "robocell/mujoco/names.h"

namespace robocell {
namespace {

using Numbers = std::vector<double>;

constexpr double kTolerance = 0.002;  // the default `arrival_tolerance`, rad
constexpr double kSpeed = 0.02;       // rad/s, of a joint at rest with that

TEST(EnvSettling, ASaggingServoEndsItsStepAndReportsTheError) {
  ModelFolder folder;
  Env env(OneHinge(folder));
  env.Reset({.seed = 1});
  for (const double move : {0.05, -0.08, 0.02}) {
    const double before = env.scene().time();
    const EnvStep step = env.Step(Numbers{move});
    EXPECT_EQ(step.reason, EndReason::kSettled) << move;
    EXPECT_LT(env.scene().time() - before, 0.8) << "it does not wait for the time to be up";
    const double sag = SagOfOneHinge(env);
    ASSERT_GT(sag, 10 * kTolerance);
    EXPECT_NEAR(env.motions()[0].joint_error, sag, kTolerance) << move;
    EXPECT_NEAR(env.motions()[0].position_error, 0.5 * sag, 0.5 * kTolerance) << move;
    EXPECT_LE(env.motions()[0].joint_speed, kSpeed) << move;
    EXPECT_NEAR(env.motions()[0].linear_speed, 0.5 * env.motions()[0].joint_speed, 1e-9) << move;
  }
}

// The robot's model does not include the load.
TEST(EnvSettling, AnArmThatSagsUnderALoadSettles) {
  ModelFolder folder;
  Env env(OneHinge(folder, "damping='2'", true));
  env.Reset({.seed = 1});
  const Scene& scene = env.scene();
  const int link = FindId(scene.model(), mjOBJ_BODY, "robotrobot_link");
  scene.data()->xfrc_applied[6 * link + 4] = 2.5;  // N m, about the hinge
  const EnvStep step = env.Step(Numbers{0.02});
  EXPECT_EQ(step.reason, EndReason::kSettled);
  EXPECT_LT(step.time, 1 - 1e-9);
  EXPECT_NEAR(env.motions()[0].joint_error, 2.5 / kOneHingeStiffness, kTolerance);
}

TEST(EnvSettling, ASlowJointArrives) {
  for (const int damping : {20, 45, 70, 90}) {  // time constants of 0.5 ... 1.9 s
    ModelFolder folder;
    EnvConfig config = OneHinge(folder, fmt::format("damping='{}'", damping), true);
    config.sim.max_convergence_time = 20;
    Env env(config);
    env.Reset({.seed = 1});
    for (const double move : {0.05, -0.004}) {
      EXPECT_EQ(env.Step(Numbers{move}).reason, EndReason::kArrived) << damping << " " << move;
      EXPECT_LE(env.motions()[0].joint_error, kTolerance) << damping << " " << move;
    }
  }
}

TEST(EnvSettling, ABlockedArmSettles) {
  ModelFolder folder;
  Env env(OneHingeOnABlock(folder));
  env.Reset({.seed = 1});
  for (int i = 0; i < 4; ++i) env.Step(Numbers{0.08});
  const EnvStep step = env.Step(Numbers{0.08});
  EXPECT_EQ(step.reason, EndReason::kSettled);
  EXPECT_GT(env.motions()[0].joint_error, 0.05);
}

TEST(EnvSettling, ArrivalMeansNearAndAtRestForAnyStep) {
  Env env(Rc7Env(ControlMode::kCartesianTrpy));
  env.Reset({.seed = 1});
  Rng rng = Rng::Stream(2, "arrival");
  for (int i = 0; i < 20; ++i) {
    Numbers action(7, 1);
    const double most = i % 2 ? 0.03 : 0.003;
    for (int j = 0; j < 6; ++j) action[j] = rng.Uniform(-most, most);
    ASSERT_EQ(env.Step(action).reason, EndReason::kArrived) << i;
    EXPECT_LE(env.motions()[0].joint_error, kTolerance) << i;
    EXPECT_LE(env.motions()[0].joint_speed, kSpeed) << i;
    EXPECT_LE(env.motions()[0].position_error, 2e-3) << i;
    EXPECT_LE(env.motions()[0].linear_speed, 0.02) << i;
  }
}

TEST(EnvSettling, CopiesReportTheSameAsOneEnvironment) {
  ModelFolder folder;
  const EnvConfig config = OneHinge(folder);
  Env one(config);
  one.Reset({.seed = 1});
  EnvBatch batch(config, 2);
  batch.Reset(std::vector<std::optional<uint64_t>>{1, 1});
  for (const double move : {0.05, -0.03}) {
    const EnvStep step = one.Step(Numbers{move});
    batch.Step(Numbers{move, move});
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(batch.env(i).motions()[0].joint_error, one.motions()[0].joint_error);
      EXPECT_EQ(batch.env(i).motions()[0].linear_speed, one.motions()[0].linear_speed);
      EXPECT_TRUE(batch.ik_success(i, 0));
    }
    EXPECT_EQ(step.reason, EndReason::kSettled);
  }
}

}  // namespace
}  // namespace robocell
