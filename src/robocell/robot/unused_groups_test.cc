// Tests which gripper belongs to which arm, and the messages about unused groups.
#include "robocell/robot/unused_groups.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/robot/testing/torso.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

TEST(GripperOf, IsTheHandOnTheArmInAnyFileOrder) {
  ModelFolder folder;
  for (const std::vector<std::string>& hands :
       {std::vector<std::string>{"l", "r"}, std::vector<std::string>{"r", "l"}}) {
    const Robot robot = RobotAlone(Torso(folder, hands));
    EXPECT_EQ(robot.gripper_of("l_arm"), "l_hand");
    EXPECT_EQ(robot.gripper_of("r_arm"), "r_hand");
    EXPECT_EQ(robot.gripper().name(), "l_hand");
    EXPECT_EQ(DescribeUnusedGroups(robot),
              "arm 'l_arm' and its gripper 'l_hand' are used; r_arm, r_hand hold still");
  }
}

TEST(GripperOf, ExcludesTheHandOfAnotherArm) {
  ModelFolder folder;
  const Robot robot = RobotAlone(Torso(folder, {"r"}));
  EXPECT_FALSE(robot.has_gripper());
  EXPECT_EQ(robot.gripper_of("l_arm"), "");
  EXPECT_EQ(robot.gripper_of("r_arm"), "r_hand");
  ExpectThrow<NotFoundError>([&] { robot.gripper(); },
                             "robot 'torso': arm 'l_arm', the first of its `move_groups`, carries "
                             "no gripper: 'r_hand' is on arm 'r_arm'. Declare the arm with the "
                             "gripper first, or take group 'r_hand' by its name");
  EXPECT_EQ(DescribeUnusedGroups(robot),
            "arm 'l_arm', which carries no gripper, is used; r_arm, r_hand hold still");
}

TEST(GripperOf, ASingleArmGetsTheFirstGripper) {
  ModelFolder folder;
  RobotConfig config = Torso(folder, {"r"});
  RobotConfig alone = config;
  alone.move_groups = {};
  alone.move_groups["l_arm"] = config.move_groups["l_arm"];
  alone.move_groups["r_hand"] = config.move_groups["r_hand"];
  const Robot robot = RobotAlone(alone);
  EXPECT_EQ(robot.gripper_of("l_arm"), "r_hand");
  EXPECT_EQ(robot.gripper().name(), "r_hand");
  EXPECT_EQ(DescribeUnusedGroups(robot), "");
}

TEST(GripperOf, RejectsGroupsThatAreNotArms) {
  const Robot robot = RobotAlone(Rc7());
  EXPECT_EQ(robot.gripper_of("arm"), "gripper");
  EXPECT_EQ(DescribeUnusedGroups(robot), "");
  ExpectThrow<ArgumentError>(
      [&] { robot.gripper_of("gripper"); },
      "robot 'rc7' / group 'gripper' is of kind gripper, and grippers go with arms: arm");
  ExpectThrow<NotFoundError>([&] { robot.gripper_of("arms"); }, "Did you mean 'arm'?");
}

}  // namespace
}  // namespace robocell::internal
