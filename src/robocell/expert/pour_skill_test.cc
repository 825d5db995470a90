#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/expert/skill.h"
#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/held_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

TEST(PourSkill, PoursGrainsAndPutsTheVesselBack) {
  const SkillOutcome outcome = RollOutSkills(PourTaskConfig{.grains = 20});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"carry", "pour", "lower", "release", "retreat"}));
}

}  // namespace
}  // namespace robocell
