#include "robocell/expert/held_object_skill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/math/pose.h"
#include "robocell/robot/action.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/held_motion.h"
#include "robocell/task/held_task_config.h"
#include "robocell/task/relation_task.h"
#include "robocell/task/start_sampler.h"
#include "robocell/task/task_sampler.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

TEST(PathWalk, ReachesTheEndAtItsSpeed) {
  HeldPath path = {Pose()};
  AppendStraight(path, Pose(Eigen::Vector3d(0.1, 0, 0)));
  PathWalk walk(path, 0.05, 1);
  for (int i = 0; i < 10; ++i) walk.Move(0.1);
  EXPECT_NEAR(walk.place().translation().x(), 0.05, 1e-9);
  for (int i = 0; i < 11; ++i) walk.Move(0.1);
  EXPECT_TRUE(walk.at_end());
  EXPECT_NEAR(walk.place().translation().x(), 0.1, 1e-12);
  walk.Restart();
  EXPECT_NEAR(walk.place().translation().x(), 0, 1e-12);
}

TEST(PathWalk, TheWayBackBeginsWhereTheWalkIs) {
  HeldPath path = {Pose()};
  AppendStraight(path, Pose(Eigen::Vector3d(0.1, 0, 0)));
  PathWalk walk(path, 0.05, 1);
  const HeldPath whole = BackAlong(path, std::nullopt);
  ASSERT_EQ(whole.size(), path.size());
  EXPECT_TRUE(whole.front().is_close(path.back(), 1e-12, 1e-12));
  for (int i = 0; i < 20; ++i) {
    const HeldPath back = BackAlong(path, walk.at());
    EXPECT_TRUE(back.front().is_close(walk.place(), 1e-12, 1e-12));
    EXPECT_TRUE(back.back().is_close(path.front(), 1e-12, 1e-12));
    for (size_t k = 1; k < back.size(); ++k) {
      const double step = back[k - 1].translation().x() - back[k].translation().x();
      EXPECT_GE(step, 0);
      EXPECT_LE(step, 0.005 + 1e-9);  // as fine as the path
    }
    walk.Move(0.113);
  }
}

// Has nothing to do at its path, and puts the object back.
class PutsBack : public HeldObjectSkill {
 public:
  using HeldObjectSkill::HeldObjectSkill;

 private:
  void BeginPath(const Scene& /*scene*/) override {}
  std::optional<Guidance> Guide(const Scene& /*scene*/) override { return std::nullopt; }
  std::string path_phase() const override { return "insert"; }
  bool returns() const override { return true; }
};

// It was never on the path: the way back begins at the path's start, and not at its end.
TEST(HeldObjectSkill, PutsBackFromTheStartOfThePathWhatNeedsNoMotion) {
  RunConfig run = ExampleRun("pick_and_place.yaml");
  run.start = {};
  run.task = InsertTaskConfig{.shapes = {"square"}};
  StartSampler sampler(run);
  std::optional<EpisodeStart> start;
  for (int attempt = 0; attempt < 40 && !start; ++attempt) {
    Rng rng = Rng::Stream(1, "start", attempt);
    start = sampler.Sample({.attempt = attempt}, rng).start;
  }
  ASSERT_TRUE(start);
  Scene scene = start->scene;
  const auto task = std::dynamic_pointer_cast<RelationTask>(start->task);
  task->Begin(scene);
  Robot robot = RobotsOf(scene).front();
  const double tick = run.rates.policy_period();
  PutsBack skill({.robot = robot.name(), .sim = run.options, .tick = tick}, task->goals().front());
  Rng rng = Rng::Stream(1, "skill");
  skill.Begin(scene, rng);
  std::optional<Pose> before;
  int returning = 0;
  for (int row = 0; row < 300 && skill.phase() != "release"; ++row) {
    const Action action = skill.Act(scene, rng);
    ASSERT_EQ(skill.failure(), "");
    const RobotAction& command = action.at(robot.name());
    if (const auto arm = command.find(robot.arm().name()); arm != command.end()) {
      const Pose hand = robot.chain().Fk(arm->second.values);
      // 0.2 m/s, and corrections.
      if (skill.phase() == "lower" && before) {
        EXPECT_LT((hand.translation() - before->translation()).norm(), 0.2 * tick + 0.005);
        ++returning;
      }
      before = hand;
    }
    EXPECT_TRUE(robot.Apply(command).ok);
    for (int i = 0; i < 33; ++i) {
      robot.Update();
      EXPECT_TRUE(scene.Step().ok());
    }
  }
  EXPECT_GT(returning, 5);
}

// The object slips twice: first it falls to where it was, then out of reach.
TEST(HeldObjectSkill, PicksUpAgainWhatSlippedAndStaysWhenThatIsOutOfReach) {
  std::optional<Pose> start;
  int slips = 0;
  std::string before;
  const SkillOutcome outcome =
      RollOutSkills(InsertTaskConfig{.shapes = {"square"}}, 1,
                    [&](Scene& scene, int /*row*/, const std::string& phase) {
                      const std::string body = scene.compiled()->object("target").root_body;
                      if (!start) start = scene.body_pose(body);
                      if (phase == "transfer" && before != phase) {
                        const Eigen::Vector3d away(slips++ == 0 ? 0 : 3, 0, 0.001);
                        scene.SetBodyPose(body, Pose(away) * *start);
                      }
                      before = phase;
                    });
  EXPECT_EQ(slips, 2);
  EXPECT_EQ(std::ranges::count(outcome.phases, "transfer"), 2);
  EXPECT_EQ(std::ranges::count(outcome.phases, "lift"), 2);
  EXPECT_FALSE(outcome.success);
  EXPECT_NE(outcome.failure, "");
}

}  // namespace
}  // namespace robocell::internal
