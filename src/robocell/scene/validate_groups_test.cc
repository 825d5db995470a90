// Tests groups of a robot file that do not fit the body tree of its model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/scene/testing/robot_files.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using Groups = RobotFiles;

TEST_F(Groups, AnActuatorOfTwoGroups) {
  const std::string file = RobotFile(
      "move_groups:\n"
      "  arm: {kind: arm, joints: [shoulder, elbow], actuators: [servo1, servo2]}\n"
      "  tip: {joints: [elbow], actuators: [servo2]}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file +
                             ":5:38: move_groups.tip.actuators[0]: actuator 'servo2' is commanded "
                             "by move_groups.arm and move_groups.tip; leave it out of one");
}

TEST_F(Groups, AnActuatorOfAGroupAndAnArm) {
  const std::string file = RobotFile(
      "move_groups:\n"
      "  tip: {actuators: [servo2]}\n"
      "  arm: {kind: arm, joints: [shoulder, elbow]}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file +
                             ":4:21: robot 'left': move_groups.tip.actuators[0]: actuator 'servo2' "
                             "is commanded by move_groups.tip and move_groups.arm (it drives its "
                             "joints); leave it out of one");
}

TEST_F(Groups, AJointOfTwoDrivenArms) {
  const std::string file = RobotFile(
      "move_groups:\n"
      "  one: {kind: arm, joints: [shoulder, elbow]}\n"
      "  two: {kind: arm, joints: [shoulder]}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file +
                             ":5:29: robot 'left': move_groups.two.joints[0]: joint 'shoulder' is "
                             "listed by move_groups.one and move_groups.two, which both have "
                             "actuators; leave it out of one");
}

TEST_F(Groups, ALeafFrameOnAFinger) {
  folder.Write("gripper", kTwoFingerGripper);
  const std::string file = RobotFile(
      "attachments: [{mjcf_path: gripper.xml, attach_to: {site: flange}}]\n"
      "move_groups:\n"
      "  arm: {kind: arm, joints: [shoulder, elbow], leaf: {body: left}}\n"
      "  gripper: {kind: gripper, joints: [left_slide, right_slide], actuators: grip}\n");
  ExpectThrow<SpecError>(
      [&] { BuildRobot(file); },
      file +
          ":5:53: robot 'left': move_groups.arm.leaf: body 'left' hangs on 'left_slide' too, a "
          "joint of group 'gripper', and the arm lists shoulder, elbow; name as `leaf` what the "
          "last joint, 'elbow', carries, for example {site: pinch}. Sites there: flange, pinch. "
          "Bodies there: fore, palm");
}

TEST_F(Groups, JointsThatDoNotLeadToTheLeafFrame) {
  const std::string swapped = RobotFile(
      "move_groups:\n"
      "  arm: {kind: arm, joints: [elbow, shoulder], leaf: {site: flange}}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(swapped); },
                         swapped +
                             ":4:28: robot 'left': move_groups.arm.joints: lists elbow, "
                             "shoulder, but the joints from 'base' to the arm's leaf are "
                             "shoulder, elbow; list those, in this order");
  const std::string still = RobotFile(
      "move_groups:\n"
      "  arm: {kind: arm, joints: [shoulder, elbow], leaf: {body: base}}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(still); },
                         still +
                             ":4:53: robot 'left': move_groups.arm.leaf: there is no joint "
                             "between 'base' and the arm's leaf, so nothing moves; name as "
                             "`leaf` what the last joint, 'elbow', carries, for example {site: "
                             "flange}. Sites there: flange. Bodies there: fore");
  const std::string one_missing = RobotFile("move_groups: {arm: {kind: arm, joints: [elbow]}}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(one_missing); },
                         one_missing +
                             ":3:40: robot 'left': move_groups.arm.joints: lists elbow, "
                             "but the joints from 'base' to the arm's leaf are shoulder, "
                             "elbow; list those, in this order, or name its `leaf`. Or, if "
                             "'shoulder' has a separate group (a waist that two arms hang on, a "
                             "lift): `root_body: upper` at the top level of the robot file; the "
                             "arms begin behind it");
  BuildRobot(
      RobotFile("root_body: upper\n"
                "move_groups: {arm: {kind: arm, joints: [elbow]}}\n"));
}

TEST_F(Groups, AJointOfTheRootItself) {
  const std::string model = folder.Write(
      "cart", R"(<worldbody><body name="sled"><joint name="rail" type="slide"/><geom size=".1"/>
      <body name="link"><joint name="j2"/><geom size=".1"/></body></body></worldbody>)");
  const std::string file = (folder.path() / "cart.yaml").string();
  std::ofstream(file) << "name: left\nmodel: cart.xml\n"
                      << "move_groups: {arm: {kind: arm, joints: [rail, j2]}}\n";
  ExpectThrow<SpecError>(
      [&] { BuildRobot(file); },
      file +
          ":3:40: robot 'left': move_groups.arm.joints: 'rail' moves the root body 'sled' itself, "
          "and an arm begins behind the root. Put a body without joints around 'sled' in the "
          "model, or give 'rail' a separate group: {kind: generic, joints: [rail], actuators: "
          "[NAME]}");
}

TEST_F(Groups, ADuplicateFinger) {
  folder.Write("gripper", kTwoFingerGripper);
  const std::string file = RobotFile(
      "attachments: [{mjcf_path: gripper.xml, prefix: g_, attach_to: {site: flange}}]\n"
      "move_groups:\n"
      "  hand: {kind: gripper, actuators: [g_grip], fingers: [{body: g_left}, {body: g_left}]}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         "move_groups.hand.fingers: both fingers are body 'g_left'; name one "
                         "body of each finger");
}

TEST_F(Groups, AnActuatorThatMovesTheWholeHand) {
  folder.Write("gripper", kTwoFingerGripper);
  const std::string fields =
      "attachments: [{mjcf_path: gripper.xml, prefix: g_, attach_to: {site: flange}}]\n"
      "move_groups:\n"
      "  carrier: {joints: [shoulder, elbow]}\n"
      "  gripper: {kind: gripper, joints: [g_left_slide, g_right_slide], actuators: [";
  BuildRobot(RobotFile(fields + "g_grip]}\n"));
  const std::string wrong = RobotFile(fields + "servo2]}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(wrong); },
                         wrong +
                             ":6:79: robot 'left': move_groups.gripper.actuators[0]: 'servo2' "
                             "moves the whole hand, not a finger. The actuators that move its "
                             "fingers: g_grip");
}

TEST_F(Groups, ABallJointIsNotSuggested) {
  folder.Write("ball", R"(<worldbody><body name="base"><geom size="0.1"/>
      <body name="upper"><joint name="hip" axis="0 1 0"/><geom size="0.1"/>
      <body name="fore"><joint name="elbow" type="ball"/><geom size="0.1"/><site name="tip"/>
      </body></body></body></worldbody>)");
  const std::string file =
      File("ball.yaml",
           "name: arm\nmodel: ball.xml\n"
           "move_groups: {arm: {kind: arm, joints: [hip], leaf: {site: tip}}}\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file +
                             ":3:53: robot 'left': move_groups.arm.leaf: 'elbow' between "
                             "'base' and the arm's leaf is neither a hinge nor a slide, and an arm "
                             "has only those: name a `leaf` before it, or put hinges in its "
                             "place in the model");
}

}  // namespace
}  // namespace robocell
