#include "robocell/spec/robot_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/robot_spec.h"
#include "robocell/spec/scene_object.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/specs.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ValidationError;

TEST(RobotConfig, AcceptsAValidConfiguration) { EXPECT_EQ(ValidationError(ArmFile()), ""); }

TEST(RobotConfig, NeedsANameAndAModel) {
  EXPECT_EQ(ValidationError(RobotConfig{}, "robot"),
            "robot is not valid, 2 problems:\n  name: is required: what this kind of robot is "
            "called\n  model: is required: the robot's MJCF file");
}

TEST(RobotConfig, ReportsNanInHomeByGroupAndIndex) {
  RobotConfig robot = ArmFile();
  robot.home["arm"][1] = std::nan("");
  EXPECT_EQ(
      ValidationError(robot),
      "it is not valid: home.arm[1]: nan is not a finite number; write a number in its place");
}

TEST(RobotConfig, HomeHasOneValuePerJoint) {
  RobotConfig robot = ArmFile();
  robot.home["arm"] = {0, 0, 0};
  EXPECT_THAT(ValidationError(robot), HasSubstr("home.arm: has 3 values for the 2 joints a, b: the "
                                                "last, 0, is of no joint. Give one for each, in "
                                                "this order, radians for hinges and metres for "
                                                "slides"));
  robot.home["arm"] = {0.5};
  EXPECT_THAT(ValidationError(robot),
              HasSubstr("home.arm: has 1 value for the 2 joints a, b: b has none. Give one"));
  robot.home["arm"] = {};
  EXPECT_THAT(ValidationError(robot), HasSubstr("joints a, b: a, b have none. Give one"));
}

TEST(RobotConfig, NoiseHasOneValueOrOnePerJoint) {
  RobotConfig robot = ArmFile();
  robot.home_noise["arm"] = {0.1};
  EXPECT_EQ(ValidationError(robot), "");
  robot.home_noise["arm"] = {0.1, 0.1, 0.1};
  EXPECT_THAT(ValidationError(robot), HasSubstr("home_noise.arm: has 3 values"));
  robot.home_noise["arm"] = {-0.1};
  EXPECT_THAT(ValidationError(robot), HasSubstr("home_noise.arm[0]: -0.1 must not be negative"));
}

TEST(RobotConfig, SuggestsTheNearestGroup) {
  RobotConfig robot = ArmFile();
  robot.control["hnad"] = ControlKind::kJointPosition;
  EXPECT_THAT(ValidationError(robot), HasSubstr("control.hnad: no move group 'hnad'. Known move "
                                                "groups: arm, hand. Did you mean 'hand'?"));
}

TEST(RobotConfig, NamesAJointMissingFromANumberedList) {
  RobotConfig robot = ArmFile();
  robot.home = {};
  MoveGroupConfig& arm = robot.move_groups["arm"];
  arm.joints = {"j1", "j2", "j4"};
  arm.actuators = {"servo1", "servo2", "servo3", "servo4"};
  EXPECT_THAT(ValidationError(robot), HasSubstr("4 actuators for 3 joints. Is j3 missing?"));
  arm.joints = {"j1", "j2", "j3", "j4"};
  arm.actuators = {"servo1", "servo2"};
  EXPECT_THAT(ValidationError(robot), HasSubstr("4 joints. Are servo3, servo4 missing?"));
  // Names with other numbers or none give no guess.
  for (const std::string first : {"servo0", "shoulder", "7"}) {
    arm.actuators = {first, "servo1", "servo2"};
    EXPECT_THAT(ValidationError(robot), Not(HasSubstr("missing?"))) << first;
  }
}

TEST(RobotConfig, AnArmHasOneActuatorPerJoint) {
  RobotConfig robot = ArmFile();
  robot.move_groups["arm"].actuators = {"x"};
  EXPECT_THAT(ValidationError(robot),
              HasSubstr("move_groups.arm.actuators: an arm has one actuator "
                        "per joint: 1 actuator for 2 joints"));
  robot.move_groups["arm"].joints = {};
  robot.home = {};
  EXPECT_THAT(ValidationError(robot), HasSubstr("an arm needs its joints, for example "
                                                "joint1..joint7"));
}

TEST(RobotConfig, AGripperNeedsTwoFingersAndADirection) {
  RobotConfig robot = ArmFile();
  MoveGroupConfig& hand = robot.move_groups["hand"];
  hand.fingers = {{.name = "only"}};
  hand.ctrl->closed = 0;
  hand.distance = GripperDistance{.closed = 0.08, .open = 0.08};
  hand.actuators = {};
  EXPECT_EQ(ValidationError(robot),
            "it is not valid, 4 problems:\n"
            "  move_groups.hand.actuators: a gripper needs the actuator that moves it\n"
            "  move_groups.hand.fingers: a gripper has two fingers or more, this one names 1; of "
            "three and "
            "more the first closes against the others\n"
            "  move_groups.hand.distance: closed (0.08 m) must be smaller than open (0.08 m)\n"
            "  move_groups.hand.ctrl: open and closed are both 0");
}

TEST(RobotConfig, OnlyGrippersHaveFingers) {
  RobotConfig robot = ArmFile();
  robot.move_groups["arm"].fingers = {{.name = "x"}};
  EXPECT_THAT(ValidationError(robot), HasSubstr("belong to a gripper; this group's kind is arm"));
}

TEST(RobotConfig, RejectsDuplicateJoints) {
  RobotConfig robot = ArmFile();
  robot.move_groups["arm"].joints = {"a", "a"};
  EXPECT_THAT(ValidationError(robot), HasSubstr("move_groups.arm.joints: 'a' is listed twice"));
}

TEST(RobotConfig, ATcpOffsetNeedsItsSite) {
  RobotConfig robot = ArmFile();
  robot.tcp_offset = Pose();
  EXPECT_THAT(ValidationError(robot), HasSubstr("tcp_offset: is relative to attachment_site"));
}

TEST(RobotConfig, NamesInDatasetsHaveNoSlash) {
  RobotConfig robot = ArmFile();
  robot.name = "lab/arm";
  const std::string why =
      " cannot be a name here: datasets have it in their columns' names, robots/ROBOT/GROUP and "
      "objects/OBJECT; write it without '/' and control characters";
  EXPECT_EQ(ValidationError(robot), "it is not valid: name: 'lab/arm'" + why);
  robot.name = "arm";
  robot.move_groups["left/arm"] = robot.move_groups.at("arm");
  EXPECT_EQ(ValidationError(robot), "it is not valid: move_groups: 'left/arm'" + why);
  EXPECT_EQ(ValidationError(RobotSpec{.name = "a/b", .config = ArmFile()}),
            "it is not valid: name: 'a/b'" + why);
  const SceneObject cube{.name = "a/b", .mjcf_path = "cube.xml"};
  EXPECT_EQ(ValidationError(cube), "it is not valid: name: 'a/b'" + why);
}

}  // namespace
}  // namespace robocell
