#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/expert/skill.h"
#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/held_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

TEST(WipeSkill, WipesAnArea) {
  const SkillOutcome outcome = RollOutSkills(WipeTaskConfig{});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"transfer", "wipe", "release", "retreat"}));
}

}  // namespace
}  // namespace robocell
