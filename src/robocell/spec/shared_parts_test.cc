#include "robocell/spec/shared_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/robot_config.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/specs.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ValidationError;

TEST(SharedParts, AnActuatorIsCommandedByOneGroup) {
  RobotConfig robot = ArmFile();
  robot.move_groups["arm"].actuators = {"x", "y"};
  robot.move_groups["wrist"] = {.joints = {"b"}, .actuators = {"z", "y"}};
  EXPECT_EQ(ValidationError(robot),
            "it is not valid: move_groups.wrist.actuators[1]: actuator 'y' is commanded by "
            "move_groups.arm and move_groups.wrist; leave it out of one");
  robot.move_groups["wrist"].actuators = {"y", "x"};
  EXPECT_THAT(ValidationError(robot),
              HasSubstr("move_groups.wrist.actuators[0]: actuators y, x are commanded by "
                        "move_groups.arm and move_groups.wrist; leave them out of one"));
}

TEST(SharedParts, GroupsThatAreCommandedShareNoJoints) {
  RobotConfig robot = ArmFile();
  robot.move_groups["arm"].actuators = {"x", "y"};
  robot.move_groups["hand"].joints = {"b", "r"};
  EXPECT_EQ(ValidationError(robot),
            "it is not valid: move_groups.hand.joints[0]: joint 'b' is listed by move_groups.arm "
            "and move_groups.hand, which both have actuators; leave it out of one");
}

TEST(SharedParts, AGroupWithoutActuatorsSharesJointsAndStartsWhereTheOtherDoes) {
  RobotConfig robot = ArmFile();
  robot.move_groups["arm"].actuators = {"x", "y"};
  robot.move_groups["wrist"] = {.joints = {"b"}};
  EXPECT_EQ(ValidationError(robot), "");
  robot.home["wrist"] = {1};
  EXPECT_EQ(ValidationError(robot), "");
  robot.home["wrist"] = {0.5};
  EXPECT_EQ(ValidationError(robot),
            "it is not valid: home.wrist[0]: is 0.5 for joint 'b', which is 1 in home.arm; give "
            "both the same, or leave the one group out of `home`");
}

}  // namespace
}  // namespace robocell::internal
