#include "robocell/rollout/action_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "robocell/data/episode_reader.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/testing/rollout_test_base.h"
#include "robocell/spec/yaml.h"

namespace robocell::internal {
namespace {

using ActionNoiseTest = RolloutTest;

constexpr double kTolerance =
    1e-3;  // of inverse kinematics, and of a joint that stands at its limit

Pose PoseAt(const std::vector<double>& numbers, size_t row) {
  const double* p = numbers.data() + 7 * row;
  return {Eigen::Vector3d(p[0], p[1], p[2]), Quaternion{p[3], p[4], p[5], p[6]}};
}

TEST_F(ActionNoiseTest, StaysWithinItsBoundsAndChangesWithEachAction) {
  const Robot robot = Robot::Of(start->scene, "rc7");
  const ActionNoiseConfig config{.translation = 0.01, .rotation = 0.05};
  ActionNoise noise({robot}, config, 0.066, Rng::Stream(1, "noise"));
  const JointVector q(robot.controller("arm").commanded_joint_pos());
  const Pose intended = robot.chain().Fk(q);
  double largest = 0;
  Pose last = intended;
  for (int tick = 0; tick < 300; ++tick) {
    const Action action = noise.Perturb();
    const std::vector<double>& values = action.at("rc7").at("arm").values;
    const Pose noisy = robot.chain().Fk(JointVector(std::span<const double>(values)));
    const Pose off = intended.inverse() * noisy;
    EXPECT_LE(off.translation().norm(), config.translation + kTolerance);
    EXPECT_LE(off.angle(), config.rotation + kTolerance);
    EXPECT_NE(noisy, last);
    last = noisy;
    largest = std::max(largest, off.translation().norm());
  }
  EXPECT_GT(largest, 0.8 * config.translation);  // the bounds are reached
}

TEST_F(ActionNoiseTest, NextActionsAreAlikeIfTheNoiseIsCorrelated) {
  const Robot robot = Robot::Of(start->scene, "rc7");
  const auto mean_step = [&](double seconds) {
    ActionNoise noise({robot}, {.translation = 0.01, .correlation_seconds = seconds}, 0.066,
                      Rng::Stream(1, "noise"));
    Pose last;
    double sum = 0;
    for (int tick = 0; tick < 200; ++tick) {
      const Action action = noise.Perturb();
      const std::vector<double>& values = action.at("rc7").at("arm").values;
      const Pose noisy = robot.chain().Fk(JointVector(std::span<const double>(values)));
      if (tick > 0) sum += (noisy.translation() - last.translation()).norm();
      last = noisy;
    }
    return sum / 199;
  };
  EXPECT_LT(mean_step(1.0), 0.5 * mean_step(0));
}

TEST_F(ActionNoiseTest, RowsHaveTheIntendedAndTheNoisyAction) {
  run.noise.emplace().translation = 0.01;
  run.noise->rotation = 0.05;
  Commanding expert(Robot::Of(start->scene, "rc7").FkFrame(), 6);
  Rng rng = Rng::Stream(2, "expert");
  RunRollout(run, *start, expert, rng,
             {.dataset = folder.path(),
              .episode_id = "noisy",
              .metadata_json = "{}",
              .keep_failures = true,
              .noise = Rng::Stream(3, "noise")});
  const Episode episode(folder / "noisy");
  const auto intended = episode.Read<double>("robots/rc7/intended/tcp_pose");
  const auto done = episode.Read<double>("robots/rc7/action/tcp_pose");
  ASSERT_EQ(intended.size(), done.size());
  for (size_t row = 0; row < static_cast<size_t>(episode.rows()); ++row) {
    const Pose off = PoseAt(intended, row).inverse() * PoseAt(done, row);
    EXPECT_GT(off.translation().norm(), 0);
    EXPECT_LE(off.translation().norm(), 0.01 + kTolerance);
    EXPECT_LE(off.angle(), 0.05 + kTolerance);
  }
  EXPECT_EQ(episode.Read<double>("robots/rc7/intended/gripper"),
            episode.Read<double>("robots/rc7/action/gripper"));
  EXPECT_EQ(episode.features().Find("robots/rc7/intended/arm").role, FeatureRole::kLabel);
}

TEST_F(ActionNoiseTest, DisplacedStartsAreFreeAndWithinTheBounds) {
  run.noise.emplace().start_translation = 0.1;
  run.noise->start_rotation = 0.3;
  Robot robot = Robot::Of(start->scene, "rc7");
  const std::vector<double> home = robot.arm().joint_pos();
  const Pose tcp = robot.FkFrame();
  double largest = 0;
  for (int i = 0; i < 10; ++i) {
    Rng rng = Rng::Stream(5, "noise", i);
    robot.SetJointPos(home);
    DisplaceStart(run, *start, rng);
    const Pose off = tcp.inverse() * robot.FkFrame();
    EXPECT_LE(off.translation().norm(), 0.1 + kTolerance);
    EXPECT_LE(off.angle(), 0.3 + kTolerance);
    largest = std::max(largest, off.translation().norm());
    MotionPlanner planner(robot);
    EXPECT_TRUE(planner.IsFree(robot.arm().joint_pos()));
    // The arm holds its new posture.
    EXPECT_EQ(JointVector(robot.controller("arm").commanded_joint_pos()),
              JointVector(std::span<const double>(robot.arm().joint_pos())));
  }
  EXPECT_GT(largest, 0.03);
}

TEST_F(ActionNoiseTest, BelongsToTheIdentityOfARunAndIsNotInItWithoutNoise) {
  const std::string without = RunIdentity(run);
  EXPECT_EQ(without.find("\nnoise:"), std::string::npos);
  run.noise.emplace();
  EXPECT_NE(RunIdentity(run), without);
}

}  // namespace
}  // namespace robocell::internal
