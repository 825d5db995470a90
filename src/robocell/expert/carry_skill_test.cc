#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>

#include "robocell/expert/skill.h"
#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/two_arm_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

TEST(CarrySkill, CarriesACase) {
  // Not every start can be done (docs/relations.md): the first of a few that can is looked at.
  SkillOutcome outcome;
  for (uint64_t seed = 1; seed <= 4 && !outcome.success; ++seed)
    outcome = RollOutSkills(CarryTaskConfig{}, seed, {}, "tasks/carry.yaml");
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases,
              IsSupersetOf({"reach", "approach", "close", "lift", "carry", "lower", "release"}));
}

}  // namespace
}  // namespace robocell
