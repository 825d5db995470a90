#include "robocell/expert/held_object_skill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>

#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/held_task_config.h"

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
