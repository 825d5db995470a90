#include "robocell/rollout/action_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/data/episode_reader.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/testing/rollout_test_base.h"
#include "robocell/spec/yaml.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class ActionNoiseTest : public RolloutTest {
 protected:
  Episode RollOut(Expert& expert, bool errors_fail = false) {
    const std::string id = "e" + std::to_string(rollouts_++);
    Rng rng = Rng::Stream(2, "expert");
    RunRollout(run, *start, expert, rng,
               {.dataset = folder.path(),
                .episode_id = id,
                .metadata_json = "{}",
                .keep_failures = true,
                .expert_errors_fail = errors_fail,
                .noise = Rng::Stream(3, "noise"),
                .start_displaced = false});
    return Episode(folder / id);
  }

 private:
  int rollouts_ = 0;
};

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

// Does in each action what it is made with.
class Doing : public Commanding {
 public:
  using Deed = std::function<RobotAction(int)>;
  Doing(int actions, Deed deed)
      : Commanding(Pose(), actions), actions_(actions), deed_(std::move(deed)) {}
  Action Act(const Scene&, Rng&) override { return {{"rc7", deed_(done_++)}}; }
  bool done() const override { return done_ >= actions_; }
  std::string results_json() const override { return results; }
  std::string results = "{}";

 private:
  int actions_, done_ = 0;
  Deed deed_;
};

TEST_F(ActionNoiseTest, NoiseDoesNotAddUpInArmsThatActionsLeaveOutOrMoveByDifferences) {
  run.noise.emplace().translation = 0.01;
  const JointVector home(Robot::Of(start->scene, "rc7").controller("arm").commanded_joint_pos());
  const std::vector<double> by(home.size(), 1e-3);
  for (const double delay : {0.0, 0.02}) {
    for (const bool is_relative : {false, true}) {
      start->randomized = {};
      if (delay > 0) start->randomized["action_delay"].numbers = {delay};
      Doing expert(40, [&](int) -> RobotAction {
        if (!is_relative) return {};
        return {{"arm", GroupCommand::RelativeJoints(by)}};
      });
      const Episode episode = RollOut(expert);
      const auto intended = episode.Read<double>("robots/rc7/intended/arm");
      const auto sent = episode.Read<double>("robots/rc7/action/arm");
      ASSERT_EQ(episode.rows(), 40);
      EXPECT_NE(intended, sent);
      for (size_t i = 0; i < intended.size(); ++i) {
        const double row = static_cast<double>(i / by.size() + 1);
        EXPECT_NEAR(intended[i] - intended[i % by.size()], is_relative ? (row - 1) * 1e-3 : 0, 1e-9)
            << "row " << row << ", delay " << delay;
      }
      Robot::Of(start->scene, "rc7").SetJointPos({home.begin(), home.end()});
    }
  }
}

TEST_F(ActionNoiseTest, AnExpertThatRaisesLeavesItsLastTargetsInTheRecord) {
  run.noise.emplace().translation = 0.01;
  const Robot robot = Robot::Of(start->scene, "rc7");
  const JointVector home(robot.controller("arm").commanded_joint_pos());
  for (const int raising : {0, 3}) {
    Doing expert(10, [&](int action) -> RobotAction {
      if (action == raising) throw ArgumentError("a part is missing");
      return {{"arm", GroupCommand::RelativeJoints(std::vector<double>(home.size(), 1e-3))}};
    });
    const Episode episode = RollOut(expert, true);
    ASSERT_EQ(episode.rows(), raising + 1);
    const auto intended = episode.Read<double>("robots/rc7/intended/arm");
    const auto joints = static_cast<size_t>(home.size());
    for (size_t joint = 0; joint < joints; ++joint) {
      EXPECT_NEAR(intended[joints * static_cast<size_t>(raising) + joint],
                  intended[joint] + 1e-3 * std::max(0, raising - 1), 1e-9);
    }
    EXPECT_THAT(episode.end_reason(), HasSubstr("a part is missing"));
    EXPECT_TRUE(nlohmann::json::parse(episode.results_json())["policy_error"].get<bool>());
  }
}

TEST_F(ActionNoiseTest, CountsTheActionsThatStayWithoutNoise) {
  run.noise.emplace().translation = 20;  // which no run file may have
  run.noise->correlation_seconds = 0;
  Doing expert(10, [](int) -> RobotAction { return {}; });
  expert.results = R"({"tries": 2})";
  const Episode episode = RollOut(expert);
  const auto results = nlohmann::json::parse(episode.results_json());
  EXPECT_EQ(results["noise"]["actions"], 10);
  EXPECT_GE(results["noise"]["actions_without_noise"], 9);
  EXPECT_EQ(results["noise"]["start_displaced"], false);
  EXPECT_EQ(results["tries"], 2);
  EXPECT_THAT(episode.warnings(), Contains(HasSubstr("actions are without noise")));
}

TEST_F(ActionNoiseTest, SaysThatAStartIsNotDisplaced) {
  Robot robot = Robot::Of(start->scene, "rc7");
  const std::vector<double> home = robot.arm().joint_pos();
  std::string log;
  const ScopedLogSink sink([&](LogLevel, std::string_view text) { log += text; });
  Rng rng = Rng::Stream(5, "noise");
  EXPECT_FALSE(DisplaceStart(run, *start, rng).has_value());
  EXPECT_EQ(log, "");
  run.noise.emplace().start_translation = 50;
  EXPECT_EQ(DisplaceStart(run, *start, rng), std::optional(false));
  EXPECT_EQ(robot.arm().joint_pos(), home);
  EXPECT_THAT(log, HasSubstr("make start_translation or start_rotation smaller"));
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
    EXPECT_EQ(DisplaceStart(run, *start, rng), std::optional(true));
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
