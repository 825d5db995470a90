#include "robocell/task/pick_task_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/task_spec.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/pour_task.h"
#include "robocell/spec/testing/random_spec.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(PickTaskConfig, BothKindsDescribeARunAlike) {
  const auto pick = PickRunOf(PickTaskConfig{.lift_height = 0.2, .objects = {{"mug"}}});
  ASSERT_TRUE(pick);
  EXPECT_EQ(pick->lift_height, 0.2);
  EXPECT_THAT(pick->objects.names, ElementsAre("mug"));
  const auto place = PickRunOf(PickAndPlaceTaskConfig{.objects = {{"box"}}});
  ASSERT_TRUE(place);
  EXPECT_EQ(place->lift_height, kLiftHeight);
  EXPECT_THAT(place->objects.names, ElementsAre("box"));
  RegisterPour();
  EXPECT_FALSE(PickRunOf(TaskSpec("pour_of_test")));
}

TEST(PickTaskConfig, HeightsAndTolerancesArePositive) {
  EXPECT_THAT(testing::ValidationError(PickTaskConfig{.lift_height = 0}), HasSubstr("lift_height"));
  EXPECT_THAT(testing::ValidationError(PickAndPlaceTaskConfig{.goal_tolerance = -1}),
              HasSubstr("goal_tolerance"));
  EXPECT_EQ(testing::ValidationError(PickAndPlaceTaskConfig{}), "");
}

template <class T>
class PickFields : public ::testing::Test {};
using BothKinds = ::testing::Types<PickTaskConfig, PickAndPlaceTaskConfig>;
TYPED_TEST_SUITE(PickFields, BothKinds);

// In a run, where the registry reads them by name, and by themselves.
TYPED_TEST(PickFields, RandomFieldsRoundTripThroughYaml) {
  for (uint64_t seed = 0; seed < 40; ++seed) {
    const auto fields = testing::RandomSpec(seed).Make<TypeParam>();
    const RunConfig run{.task = fields};
    EXPECT_TRUE(FromYamlUnchecked<RunConfig>(ToYaml(run)) == run) << ToYaml(run);
    EXPECT_TRUE(FromYamlUnchecked<TypeParam>(ToYaml(fields)) == fields) << ToYaml(fields);
  }
}

}  // namespace
}  // namespace robocell
