#include "robocell/expert/skill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/relation_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

TEST(PushSkill, PushesABlockIntoARegion) {
  const SkillOutcome outcome = RollOutSkills(PushTaskConfig{});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"reach", "approach", "push", "retreat"}));
}

}  // namespace
}  // namespace robocell
