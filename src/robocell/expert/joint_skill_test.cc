#include "robocell/expert/skill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/relation_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

TEST(JointSkill, OpensADrawerADoorAndALid) {
  for (const char* kind : {"chest", "cupboard", "lid_box"}) {
    const SkillOutcome outcome = RollOutSkills(OpenTaskConfig{.objects = {kind}});
    EXPECT_TRUE(outcome.success) << kind << ": " << outcome.failure;
    EXPECT_THAT(outcome.phases, IsSupersetOf({"reach", "approach", "close", "follow", "release"}));
  }
}

TEST(JointSkill, ClosesADrawer) {
  const SkillOutcome outcome = RollOutSkills(CloseTaskConfig{.objects = {"chest"}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

TEST(JointSkill, PressesAButton) {
  const SkillOutcome outcome = RollOutSkills(PressTaskConfig{});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"reach", "approach", "press"}));
}

}  // namespace
}  // namespace robocell
