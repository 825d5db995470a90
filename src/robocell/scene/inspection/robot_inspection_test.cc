#include "robocell/scene/inspection/robot_inspection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/scene/testing/arm_with_hand.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

using RobotInspectionTest = ArmWithHand;

TEST_F(RobotInspectionTest, EveryCompileWarnsAboutSuspiciousValues) {
  EXPECT_THAT(Warnings({}), Not(Contains(HasSubstr("'hip'"))));
  for (int compile = 0; compile < 2; ++compile)
    EXPECT_THAT(Warnings({.hip = "-170 170"}), Contains(HasSubstr("'hip'")));
}

TEST_F(RobotInspectionTest, WarnsInTheOrderOfTheChecks) {
  EXPECT_THAT(
      Warnings(
          {.hip = "2 -2", .knee_ctrl = "-143 143", .finger = "contype=\"0\" conaffinity=\"0\""}),
      ElementsAre(HasSubstr("no geom of the finger 'left' collides"),
                  HasSubstr("the range of joint 'hip', 2 to -2, has the larger number"),
                  AllOf(HasSubstr("Are these degrees?"), HasSubstr("servo 's2'"))));
}

}  // namespace
}  // namespace robocell::internal
