#include "robocell/expert/skill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/relation_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

TEST(PlaceSkill, StacksTwoCubes) {
  const SkillOutcome outcome = RollOutSkills(StackTaskConfig{});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"grasp", "lift", "transfer", "lower", "release"}));
}

TEST(PlaceSkill, PlacesOneObjectNextToAnother) {
  const SkillOutcome outcome =
      RollOutSkills(PlaceNextToTaskConfig{.objects = {"box"}, .references = {"mug"}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

// Two relations in a file: the second one holds something at the end.
TEST(PlaceSkill, BringsAboutTheRelationsOfAFile) {
  const SkillOutcome outcome = RollOutSkills(RelationsTaskConfig{
      .objects = {"red=box", "tray", "nut"}, .goal = {"red on tray", "nut held"}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

}  // namespace
}  // namespace robocell
