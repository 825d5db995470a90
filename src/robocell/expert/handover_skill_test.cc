#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/expert/skill.h"
#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/two_arm_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

TEST(HandoverSkill, HandsABarOver) {
  // The right arm is the giver in this start.
  const SkillOutcome outcome = RollOutSkills(HandoverTaskConfig{}, 4, {}, "tasks/handover.yaml");
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases,
              IsSupersetOf({"lift", "meet", "approach", "take", "give", "retreat"}));
}

}  // namespace
}  // namespace robocell
