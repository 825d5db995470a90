#include "robocell/expert/skill_expert.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <functional>
#include <memory>
#include <set>
#include <string>

#include "robocell/base/error.h"
#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/mujoco/names.h"
#include "robocell/task/relation_task_config.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

TEST(SkillExpert, RejectsATaskWithoutRelations) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  const EpisodeStart start{.scene = scene.scene, .task = nullptr, .target_object = "target"};
  ExpectThrow<SpecError>([&] { SkillExpert(scene.run, start); },
                         "demonstrates tasks whose goals are relations");
}

// Moves an object back, once.
void PutBack(Scene& scene, const std::string& object, const Pose& pose) {
  scene.SetBodyPose(object, pose);
  scene.Forward();
}

// The cube vanishes out of the hand: the skill fails, and the expert picks the cube up again.
TEST(SkillExpert, TriesAgainWhatSlipped) {
  Pose start;
  int lifts = 0;
  bool was_lifting = false, is_robbed = false;
  const SkillOutcome outcome =
      RollOutSkills(StackTaskConfig{}, 1, [&](Scene& scene, int row, const std::string& phase) {
        if (row == 0) start = scene.body_pose("blue_cube");
        lifts += phase == "lift" && !was_lifting;
        was_lifting = phase == "lift";
        if (phase != "transfer" || is_robbed) return;
        is_robbed = true;
        PutBack(scene, "blue_cube", start);
      });
  EXPECT_TRUE(is_robbed);
  EXPECT_EQ(lifts, 2);
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

// What the first skill did is undone after it ended.
TEST(SkillExpert, RepeatsAGoalThatWasUndone) {
  Pose start;
  int lifts = 0;
  bool was_lifting = false, is_undone = false;
  const SkillOutcome outcome =
      RollOutSkills(StackTaskConfig{}, 1, [&](Scene& scene, int row, const std::string& phase) {
        if (row == 0) start = scene.body_pose("blue_cube");
        lifts += phase == "lift" && !was_lifting;
        was_lifting = phase == "lift";
        if (phase != "done" || is_undone) return;
        is_undone = true;
        PutBack(scene, "blue_cube", start);
      });
  EXPECT_TRUE(is_undone);
  EXPECT_EQ(lifts, 2);
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

// A grip that has moved the drawer is no failure, even if it has to move it again: fingers close on the
// handle the second time, too, in place of a hook.
TEST(SkillExpert, GripsAgainWhereAGripHasHelped) {
  int grips = 0;
  bool was_gripping = false, is_undone = false;
  const SkillOutcome outcome =
      RollOutSkills(OpenTaskConfig{.objects = {"drawer_unit"}}, 1,
                    [&](Scene& scene, int, const std::string& phase) {
                      grips += phase == "close" && !was_gripping;
                      was_gripping = phase == "close";
                      if (phase != "done" || is_undone) return;
                      is_undone = true;
                      for (int j = 0; j < scene.model()->njnt; ++j) {
                        const std::string name = ElementName(scene.model(), mjOBJ_JOINT, j);
                        if (name.starts_with("target_drawer"))
                          scene.data()->qpos[scene.model()->jnt_qposadr[j]] = 0;
                      }
                      scene.Forward();
                    });
  EXPECT_TRUE(is_undone);
  EXPECT_EQ(grips, 2);
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

// A goal that is undone for ever: the expert gives up after its tries, and says why.
TEST(SkillExpert, GivesUpAfterItsTries) {
  Pose start;
  int presses = 0;
  bool was_pressing = false;
  const SkillOutcome outcome =
      RollOutSkills(OpenTaskConfig{.objects = {"drawer_unit"}}, 1,
                    [&](Scene& scene, int, const std::string& phase) {
                      presses += phase == "close" && !was_pressing;
                      was_pressing = phase == "close";
                      for (int j = 0; j < scene.model()->njnt; ++j) {  // nailed shut
                        const std::string name = ElementName(scene.model(), mjOBJ_JOINT, j);
                        if (name.starts_with("target_drawer"))
                          scene.data()->qpos[scene.model()->jnt_qposadr[j]] = 0;
                      }
                    });
  EXPECT_FALSE(outcome.success);
  EXPECT_GE(presses, 2);
  EXPECT_LE(presses, 4);
  const std::set<std::string> reasons = {"the handle slipped", "the hand closed on nothing",
                                         "the arm is blocked", "the goal was not reached"};
  EXPECT_TRUE(reasons.contains(outcome.failure)) << outcome.failure;
}

}  // namespace
}  // namespace robocell
