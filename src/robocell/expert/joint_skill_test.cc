#include "robocell/expert/skill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/relation_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

TEST(JointSkill, OpensDrawersDoorsLidsAndALever) {
  for (const char* kind : {"drawer_unit", "cupboard", "lid_box", "microwave", "laptop", "faucet"}) {
    const SkillOutcome outcome = RollOutSkills(OpenTaskConfig{.objects = {kind}});
    EXPECT_TRUE(outcome.success) << kind << ": " << outcome.failure;
    EXPECT_THAT(outcome.phases, IsSupersetOf({"reach", "approach", "close", "follow", "release"}));
  }
}

TEST(JointSkill, ClosesADrawer) {
  const SkillOutcome outcome = RollOutSkills(CloseTaskConfig{.objects = {"drawer_unit"}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

TEST(JointSkill, PressesAButton) {
  const SkillOutcome outcome = RollOutSkills(PressTaskConfig{});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"reach", "approach", "press"}));
}

TEST(JointSkill, PressesAButtonFromTheSide) {
  const SkillOutcome outcome = RollOutSkills(PressTaskConfig{.objects = {"microwave"}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

}  // namespace
}  // namespace robocell
