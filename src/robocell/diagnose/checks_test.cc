#include "robocell/diagnose/checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/scene/testing/arm_with_hand.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::NotNull;

TEST(Checks, AreAllListed) {
  EXPECT_THAT(ModelChecks(), Each(NotNull()));
  EXPECT_THAT(RobotTrials(), Each(NotNull()));
  EXPECT_EQ(ModelChecks()[0], &CheckScale);
  EXPECT_EQ(RobotTrials()[0], &TryFirstArm);
}

// Scenes do not know this layer, but every compile warns.
using CompileWarnings = ArmWithHand;
TEST_F(CompileWarnings, AreThoseOfAllModelChecksInTheirOrder) {
  EXPECT_THAT(
      Warnings(
          {.hip = "2 -2", .knee_ctrl = "-143 143", .finger = "contype=\"0\" conaffinity=\"0\""}),
      ElementsAre(HasSubstr("no geom of the finger 'left' collides"),
                  HasSubstr("the range of joint 'hip', 2 to -2, has the larger number"),
                  AllOf(HasSubstr("Are these degrees?"), HasSubstr("servo 's2'"))));
}

}  // namespace
}  // namespace robocell::internal
