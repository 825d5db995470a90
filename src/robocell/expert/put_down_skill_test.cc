#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "robocell/expert/skill.h"
#include "robocell/scenes/relations.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

// A picked object is back on the table, upright, and the open hand is away from it.
TEST(PutDownSkill, SetsDownWhatIsInTheHand) {
  PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  Scene& scene = pick.scene;
  Rng rng = Rng::Stream(1, "test");
  const RelationTask::Goal goal{.stated = ParseRelation("target on table"), .bound = nullptr};
  const std::unique_ptr<Skill> skill =
      MakePutDownSkill({.robot = "rc7", .sim = pick.run.options}, goal);
  PickPlanner planner("rc7", "target", pick.run.options);
  const auto simulate = [&](auto& actor) {
    actor.Begin(scene, rng);
    for (int row = 0; row < 300 && !actor.done(); ++row) {
      EXPECT_TRUE(pick.robot.Apply(actor.Act(scene, rng).at("rc7")).ok);
      for (int i = 0; i < 33; ++i) {
        pick.robot.Update();
        EXPECT_TRUE(scene.Step().ok());
      }
    }
    EXPECT_TRUE(actor.done());
    EXPECT_EQ(actor.failure(), "");
  };
  const Pose before = scene.body_pose(pick.target_body);
  simulate(planner);
  ASSERT_TRUE(pick.robot.gripper().is_grasping(pick.target_body));
  ASSERT_GT(scene.body_pose(pick.target_body).translation().z(), before.translation().z() + 0.05);
  simulate(*skill);
  EXPECT_FALSE(pick.robot.gripper().is_grasping(pick.target_body));
  EXPECT_GT(pick.robot.gripper().opening(), 0.9);
  const Pose after = scene.body_pose(pick.target_body);
  EXPECT_NEAR(after.translation().z(), before.translation().z(), 3e-3);
  EXPECT_GT(after.rotation().col(2).z(), 0.99);
  EXPECT_GT((pick.robot.tcp_in_world().translation() - after.translation()).norm(), 0.08);
}

}  // namespace
}  // namespace robocell
