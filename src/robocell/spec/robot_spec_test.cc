#include "robocell/spec/robot_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/robot_config.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/specs.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ValidationError;

TEST(RobotSpec, NeedsAModelOrAConfiguration) {
  EXPECT_THAT(ValidationError(RobotSpec{}),
              HasSubstr("path: is empty: give the robot's model file"));
  EXPECT_THAT(ValidationError(RobotSpec{.path = "a.xml", .config = ArmFile()}),
              HasSubstr("path: is set together with config"));
}

TEST(RobotSpec, ReportsErrorsOfItsConfiguration) {
  RobotSpec spec{.config = ArmFile()};
  spec.config->reach = 0;
  EXPECT_EQ(ValidationError(spec), "it is not valid: config.reach: 0 must be greater than 0");
}

TEST(RobotSpec, ItsBaseOverridesTheConfiguration) {
  RobotSpec spec{.config = ArmFile()};
  spec.config->base.kind = BaseKind::kFree;
  EXPECT_EQ(spec.EffectiveBase().kind, BaseKind::kFree);
  spec.base = BaseConfig{.kind = BaseKind::kMocap};
  EXPECT_EQ(spec.EffectiveBase().kind, BaseKind::kMocap);
  EXPECT_EQ(RobotSpec{}.EffectiveBase().kind, BaseKind::kFixed);
}

}  // namespace
}  // namespace robocell
