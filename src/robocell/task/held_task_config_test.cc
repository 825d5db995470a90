#include "robocell/task/held_task_config.h"

#include <gtest/gtest.h>

#include "robocell/spec/run_config.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

template <class T>
size_t Mistakes(const T& fields) {
  Problems problems;
  fields.Validate(problems);
  return problems.list().size();
}

TEST(HeldTaskConfig, RejectsTasksThatCannotBe) {
  EXPECT_EQ(Mistakes(InsertTaskConfig{}), 0u);
  EXPECT_EQ(Mistakes(InsertTaskConfig{.shapes = {"square", "star"}, .clearance = 0.02}), 2u);
  EXPECT_EQ(Mistakes(InsertTaskConfig{.depth = 0}), 1u);
  EXPECT_EQ(Mistakes(WipeTaskConfig{.share = 0}), 1u);
  EXPECT_EQ(Mistakes(PourTaskConfig{.share = 0}), 1u);
  EXPECT_EQ(Mistakes(SortTaskConfig{.objects = 1}), 1u);
  EXPECT_EQ(Mistakes(SortTaskConfig{.objects = 7}), 1u);
  EXPECT_EQ(Mistakes(SortTaskConfig{}), 0u);
  EXPECT_EQ(Mistakes(WipeTaskConfig{.distance = {0.05, 0.2}}), 1u);
  EXPECT_EQ(Mistakes(WipeTaskConfig{}), 0u);
  EXPECT_EQ(Mistakes(PourTaskConfig{.grains = 3}), 1u);
  EXPECT_EQ(Mistakes(PourTaskConfig{}), 0u);
}

TEST(HeldTaskConfig, SurvivesYaml) {
  const auto again = FromYamlUnchecked<InsertTaskConfig>(
      ToYaml(InsertTaskConfig{.shapes = {"round"}, .clearance = 0.0005, .depth = 0.9}));
  EXPECT_EQ(again.shapes, (NameList{"round"}));
  EXPECT_EQ(again.clearance, 0.0005);
  EXPECT_EQ(again.depth, 0.9);
}

}  // namespace
}  // namespace robocell
