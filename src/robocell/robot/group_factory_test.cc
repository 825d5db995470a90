// Tests that problems of a robot's groups are reported with their line in the robot's file.
#include "robocell/robot/group_factory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "robocell/base/files.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/robot/validate_config.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Two fingers 2 cm apart, which one servo moves 3 cm farther apart each.
constexpr const char* kHand = R"(
  <worldbody><body name="palm"><geom size="0.01" mass="0.1"/><site name="pinch" pos="0 0 0.1"/>
    <body name="l" pos="0 0.02 0.1"><joint name="s1" type="slide" axis="0 1 0"/><geom size="0.01" mass="0.1"/></body>
    <body name="r" pos="0 -0.02 0.1"><joint name="s2" type="slide" axis="0 -1 0"/><geom size="0.01" mass="0.1"/></body>
  </body></worldbody>
  <equality><joint joint1="s1" joint2="s2"/></equality>
  <actuator><position name="grip" joint="s1" kp="100" kv="9" ctrlrange="0 0.03"/></actuator>)";

class LocatedRobot : public ::testing::Test {
 protected:
  LocatedRobot() {
    folder_.Write("arm", kTwoJointArm);
    folder_.Write("gripper", kHand);
  }
  // Makes the two-joint arm with the two-finger gripper; `fields` begin in line 4.
  Robot Make(const std::string& fields) {
    AtomicWrite(file_,
                "name: arm\nmodel: arm.xml\n"
                "attachments: [{mjcf_path: gripper.xml, prefix: g_, attach_to: {site: flange}}]\n" +
                    fields);
    return RobotAlone(RobotConfig::Load(file_));
  }

  ModelFolder folder_;
  const std::string file_ = (folder_.path() / "arm.yaml").string();
  const std::string arm_ = "  arm: {kind: arm, joints: [shoulder, elbow], leaf: {site: g_pinch}}\n";
};

TEST_F(LocatedRobot, AGripperWithOpenAndClosedSwapped) {
  const Robot robot = Make("move_groups:\n" + arm_ +
                           "  gripper: {kind: gripper, joints: [g_s1, g_s2], actuators: g_grip,\n"
                           "            ctrl: {open: 0, closed: 0.03}}\n");
  const std::string message =
      ExpectThrow<ArgumentError>([&] { robot.gripper().opening(); },
                                 file_ + ":7:19: robot 'arm' / group 'gripper': the fingers are ");
  EXPECT_THAT(message, HasSubstr("open and closed are swapped"));
}

TEST_F(LocatedRobot, AWrongDistanceThatCannotBeMeasuredHasOnePlace) {
  const Robot robot =
      Make("move_groups:\n" + arm_ +
           "  gripper: {kind: gripper, joints: [g_s1, g_s2], actuators: g_grip,\n"
           "            distance: {closed: 0, open: 0.1}, ctrl: {open: 0, closed: 0.03}}\n");
  Problems problems(robot.config().locations);
  ValidateConfig(robot, problems);
  const std::string text = problems.Text("arm.yaml");
  EXPECT_THAT(text, HasSubstr("is not valid: " + file_ + ":7:53: robot 'arm' / group 'gripper'"));
  EXPECT_EQ(text.find(file_), text.rfind(file_)) << text;
}

TEST_F(LocatedRobot, AnArmWithServosOnSomeOfItsJoints) {
  ExpectThrow<ArgumentError>(
      [&] { Make("edits: [{delete: {actuator: servo2}}]\nmove_groups:\n" + arm_); },
      file_ + ":6:8: robot 'arm' / group 'arm': 1 of its joints has no position servo: elbow");
}

TEST_F(LocatedRobot, AControllerThatTheArmCannotHave) {
  std::string motors = std::regex_replace(kTwoJointArm, std::regex("<position"), "<motor");
  motors = std::regex_replace(motors, std::regex(R"( k[pv]="\d+")"), "");
  folder_.Write("arm", motors);
  ExpectThrow<ArgumentError>(
      [&] { Make("move_groups:\n" + arm_ + "control: {arm: joint_position}\n"); },
      file_ +
          ":6:16: scene 'test' / robot 'arm' / group 'arm' cannot be driven to positions: 'servo1' "
          "is a motor, no position servo: write `control: {arm: joint_impedance}` at the top level "
          "of the robot file");
}

}  // namespace
}  // namespace robocell::internal
