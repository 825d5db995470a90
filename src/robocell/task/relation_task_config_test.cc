#include "robocell/task/relation_task_config.h"

#include <gtest/gtest.h>

#include "robocell/spec/run_config.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

TEST(RelationTaskConfig, SurvivesYaml) {
  RelationsTaskConfig fields{.objects = {"red=box", "tray"},
                             .start = {"red next_to tray 0.05"},
                             .goal = {"red on tray"},
                             .hold_seconds = 0.5};
  const auto again = FromYamlUnchecked<RelationsTaskConfig>(ToYaml(fields));
  EXPECT_EQ(again.objects, fields.objects);
  EXPECT_EQ(again.start, fields.start);
  EXPECT_EQ(again.goal, fields.goal);
  EXPECT_EQ(again.hold_seconds, 0.5);
}

template <class T>
size_t MistakesOf(const T& fields) {
  Problems problems;
  fields.Validate(problems);
  return problems.list().size();
}

TEST(RelationTaskConfig, RejectsGoalsThatCannotBe) {
  EXPECT_EQ(MistakesOf(RelationsTaskConfig{.goal = {"a on b"}}), 0u);
  EXPECT_EQ(MistakesOf(RelationsTaskConfig{}), 1u);
  EXPECT_EQ(MistakesOf(RelationsTaskConfig{.start = {"x"}, .goal = {"a on b", "a onn b"}}), 2u);
  EXPECT_EQ(MistakesOf(StackTaskConfig{.cubes = 1}), 1u);
  EXPECT_EQ(MistakesOf(StackTaskConfig{.cubes = 7}), 1u);
  EXPECT_EQ(MistakesOf(OpenTaskConfig{.opening = 0.3, .start_opening = {0, 0.3}}), 1u);
  EXPECT_EQ(MistakesOf(CloseTaskConfig{.opening = 0.3, .start_opening = {0.3, 0.5}}), 1u);
  EXPECT_EQ(MistakesOf(PushTaskConfig{.distance = {0.03, 0.1}}), 1u);
  EXPECT_EQ(MistakesOf(PushTaskConfig{}), 0u);
}

}  // namespace
}  // namespace robocell
