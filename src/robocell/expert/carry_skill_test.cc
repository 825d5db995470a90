#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/expert/skill.h"
#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/two_arm_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

TEST(CarrySkill, CarriesACase) {
  const SkillOutcome outcome = RollOutSkills(CarryTaskConfig{}, 1, {}, "tasks/carry.yaml");
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases,
              IsSupersetOf({"reach", "approach", "close", "lift", "carry", "lower", "release"}));
}

}  // namespace
}  // namespace robocell
