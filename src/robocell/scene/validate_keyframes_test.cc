#include "robocell/scene/validate_keyframes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/arm_with_hand.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Optional;

using Keyframes = ArmWithHand;

TEST_F(Keyframes, ReportsValuesOutsideTheLimitsWithASuggestion) {
  Model({.angle = "degree", .hip = "-115 115", .knee = "-2 2"});
  const Scene scene = Build();
  const mjModel* m = scene.model();
  const int hip = FindId(m, mjOBJ_JOINT, "a/hip"), knee = FindId(m, mjOBJ_JOINT, "a/knee");
  EXPECT_EQ(OutsideLimits(m, hip, 1.9, "hip"), std::nullopt);
  EXPECT_THAT(OutsideLimits(m, hip, 90, "hip"),
              Optional(HasSubstr("90 is outside the limits -2.00713 to 2.00713 of joint 'hip'; "
                                 "radians, and 90 degrees are 1.5708")));
  EXPECT_THAT(OutsideLimits(m, knee, 1, "knee"),
              Optional(HasSubstr("Were radians read as degrees? The model's -2 to 2 are degrees")));
  EXPECT_THAT(OutsideLimits(m, hip, 3, "hip"), Optional(Not(HasSubstr("degrees"))));
}

TEST_F(Keyframes, OfTheModelOutsideTheLimitsGiveWarningsExceptHome) {
  Model({.rest = "<keyframe><key name=\"home\" qpos=\"0 0 0 0\"/><key name=\"far\" qpos=\"9 0 "
                 "0 0\"/></keyframe>"});
  EXPECT_THAT(Build().compiled()->warnings(),
              ::testing::Contains(HasSubstr("keyframe 'far': 9 is outside the limits -2 to 2 of "
                                            "joint 'hip'")));
}

TEST_F(Keyframes, WarnAboutAReferenceOutsideTheLimits) {
  const auto warning = HasSubstr(
      "'arm' has no home, so it begins at the model's reference position: 0 is outside the limits "
      "0.5 to 2 of joint 'hip'. Give it one: home: {arm: [1.25, 0]}");
  Model({.hip = "0.5 2"});
  EXPECT_THAT(Build().compiled()->warnings(), ::testing::Contains(warning));
  Model({.hip = "0.5 2", .rest = "<keyframe><key name=\"home\" qpos=\"1 0 0 0\"/></keyframe>"});
  EXPECT_THAT(Build().compiled()->warnings(), Not(::testing::Contains(warning)));
}

}  // namespace
}  // namespace robocell::internal
