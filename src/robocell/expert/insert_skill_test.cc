#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/expert/skill.h"
#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/held_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

TEST(InsertSkill, PutsAPegIntoItsHole) {
  const SkillOutcome outcome = RollOutSkills(InsertTaskConfig{.shapes = {"square"}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"transfer", "align", "insert", "release", "retreat"}));
}

}  // namespace
}  // namespace robocell
