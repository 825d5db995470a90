#include "robocell/spec/pick_task_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/task_spec.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/pour_task.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(PickTaskConfig, BothKindsSayTheSameOfARun) {
  const auto pick = PickRunOf(PickTaskConfig{.lift_height = 0.2, .objects = {{"mug"}}});
  ASSERT_TRUE(pick);
  EXPECT_EQ(pick->lift_height, 0.2);
  EXPECT_THAT(pick->objects.names, ElementsAre("mug"));
  const auto place = PickRunOf(PickAndPlaceTaskConfig{.objects = {{"box"}}});
  ASSERT_TRUE(place);
  EXPECT_EQ(place->lift_height, kLiftHeight);
  EXPECT_THAT(place->objects.names, ElementsAre("box"));
}

TEST(PickTaskConfig, HeightsAndTolerancesArePositive) {
  EXPECT_THAT(testing::ValidationError(PickTaskConfig{.lift_height = 0}), HasSubstr("lift_height"));
  EXPECT_THAT(testing::ValidationError(PickAndPlaceTaskConfig{.goal_tolerance = -1}),
              HasSubstr("goal_tolerance"));
  EXPECT_EQ(testing::ValidationError(PickAndPlaceTaskConfig{}), "");
}

}  // namespace
}  // namespace robocell
