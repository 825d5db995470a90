#include "robocell/expert/skill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/expert/testing/skill_rollout.h"
#include "robocell/task/relation_task_config.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

class JointSkillOf : public ::testing::TestWithParam<const char*> {};

TEST_P(JointSkillOf, Opens) {
  const SkillOutcome outcome = RollOutSkills(OpenTaskConfig{.objects = {GetParam()}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  // A finger behind the handle does not close.
  EXPECT_THAT(outcome.phases, IsSupersetOf({"reach", "approach", "follow", "release"}));
}

INSTANTIATE_TEST_SUITE_P(Kinds, JointSkillOf,
                         ::testing::Values("drawer_unit", "cupboard", "lid_box", "microwave",
                                           "laptop", "faucet"),
                         [](const auto& kind) { return std::string(kind.param); });

TEST(JointSkill, PushesADrawerShut) {
  const SkillOutcome outcome = RollOutSkills(CloseTaskConfig{.objects = {"drawer_unit"}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"reach", "approach", "follow", "retreat"}));
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
