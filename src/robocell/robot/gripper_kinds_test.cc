// Tests hands of other kinds than two fingers on joints of their own: fingers that a slider below
// them drives, three fingers with an actuator each, and fingers that oscillate.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <numbers>
#include <string>

#include "robocell/base/error.h"
#include "robocell/robot/gripper_group.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class GripperKinds : public ::testing::Test {
 protected:
  Robot Hand(const std::string& model, const MoveGroupConfig& group) {
    RobotConfig config{
        .name = "hand", .model = folder_.Write("hand", model), .move_groups = {{"gripper", group}}};
    config.move_groups.at("gripper").kind = MoveGroupKind::kGripper;
    return RobotAlone(config);
  }

  static void Simulate(Robot& robot, double seconds) {
    for (double end = robot.scene().time() + seconds; robot.scene().time() < end;) {
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
  }

  ModelFolder folder_;
};

// Two fingers hang on hinges of a slider, and turn when it moves: by an equality of the joints, or
// by rods that tie them to the palm.
std::string FingersOnASlider(const std::string& equality) {
  const auto finger = [](const char* name, int side) {
    return fmt::format(
        "<body name=\"{0}\" pos=\"0 {1} 0\"><joint name=\"{0}\" axis=\"{2} 0 0\" range=\"-.6 .6\" "
        "damping=\".05\" armature=\".005\"/><geom name=\"{0}_pad\" type=\"capsule\" "
        "fromto=\"0 0 0 0 0 .1\" size=\".008\" mass=\".04\"/></body>",
        name, 0.03 * side, -side);
  };
  return "<compiler angle=\"radian\"/><worldbody><body name=\"palm\" pos=\"0 0 .5\"><geom "
         "type=\"box\" "
         "size=\".03 .06 .01\" pos=\"0 0 -.06\" mass=\".2\"/><site name=\"tcp\" pos=\"0 0 .1\"/>"
         "<body name=\"slider\"><joint name=\"slide\" type=\"slide\" axis=\"0 0 1\" "
         "range=\"-.02 .04\" damping=\"5\" armature=\".1\"/><geom size=\".005\" mass=\".02\" "
         "contype=\"0\" conaffinity=\"0\"/>" +
         finger("left", 1) + finger("right", -1) +
         "</body></body></worldbody><actuator><position name=\"push\" joint=\"slide\" kp=\"4000\" "
         "kv=\"124\" ctrlrange=\"-.02 .04\"/></actuator><equality>" +
         equality + "</equality>";
}

TEST_F(GripperKinds, FingersFollowTheSliderThatCarriesThem) {
  const std::string follow =
      "<joint joint1=\"left\" joint2=\"slide\" polycoef=\"0 10 0 0 0\" solref=\".005 1\"/>"
      "<joint joint1=\"right\" joint2=\"slide\" polycoef=\"0 10 0 0 0\" solref=\".005 1\"/>";
  for (const NameList& joints : {NameList{"slide"}, NameList{"left", "right"}}) {
    Robot robot =
        Hand(FingersOnASlider(follow), {.joints = joints,
                                        .actuators = {"push"},
                                        .fingers = {{.name = "left_pad"}, {.name = "right_pad"}}});
    const Interval range = robot.gripper().inter_finger_dist_range();
    // The fingers turn by ten times the slide s: the tips are 0.06 + 0.2 sin(10 s) - 0.016 m apart,
    // and the hinges 0.044 m, which is less when they turn outwards.
    EXPECT_NEAR(range.lower, 0.06 - 0.2 * std::sin(0.2) - 0.016, 2e-3);
    EXPECT_NEAR(range.upper, 0.044, 2e-3);
    robot.Apply({{"gripper", GroupCommand::Opening(0)}});
    Simulate(robot, 1);
    EXPECT_NEAR(robot.gripper().opening(), 0, 0.05);
    robot.Apply({{"gripper", GroupCommand::Opening(1)}});
    Simulate(robot, 1);
    EXPECT_NEAR(robot.gripper().opening(), 1, 0.05);
  }
}

// Nothing ties the fingers to anything: the actuator moves both with the slider.
TEST_F(GripperKinds, ASliderWithoutTiesMovesTheWholeHand) {
  ExpectThrow<SpecError>(
      [&] {
        Hand(FingersOnASlider(""), {.joints = {"left", "right"}, .actuators = {"push"}});
      },
      "'push' moves the whole hand, not a finger");
}

// Three fingers around the middle, one of which has its servo the other way round.
std::string ThreeFingers() {
  std::string fingers, servos;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3, x = std::cos(angle), y = std::sin(angle);
    const double sign = i == 1 ? -1 : 1;
    fingers += fmt::format(
        "<body name=\"f{0}\" pos=\"{1} {2} 0\"><joint name=\"j{0}\" type=\"slide\" "
        "axis=\"{3} {4} 0\" range=\"{5} {6}\" damping=\"10\" armature=\".1\"/>"
        "<geom name=\"pad{0}\" type=\"capsule\" fromto=\"0 0 0 0 0 .06\" size=\".01\" "
        "mass=\".05\" friction=\"1.5\"/></body>",
        i, 0.015 * x, 0.015 * y, sign * x, sign * y, sign > 0 ? 0 : -0.03, sign > 0 ? 0.03 : 0);
    servos +=
        fmt::format("<position name=\"s{0}\" joint=\"j{0}\" kp=\"1000\" ctrlrange=\"{1} {2}\"/>", i,
                    sign > 0 ? 0 : -0.03, sign > 0 ? 0.03 : 0);
  }
  return "<worldbody><body name=\"palm\" pos=\"0 0 .5\"><geom type=\"cylinder\" size=\".05 .01\" "
         "pos=\"0 0 "
         "-.02\"/>"
         "<site name=\"tcp\" pos=\"0 0 .05\"/>" +
         fingers + "</body></worldbody><actuator>" + servos + "</actuator>";
}

MoveGroupConfig ThreeFingerGroup() {
  return {.joints = {"j0", "j1", "j2"},
          .actuators = {"s0", "s1", "s2"},
          .leaf = ElementRef{.name = "tcp"},
          .fingers = {{.name = "pad0"}, {.name = "pad1"}, {.name = "pad2"}}};
}

TEST_F(GripperKinds, EachOfThreeFingersOpensByItsOwnServo) {
  Robot robot = Hand(ThreeFingers(), ThreeFingerGroup());
  GripperGroup& gripper = robot.gripper();
  const auto apart = [](double radius) { return std::sqrt(3.0) * radius - 0.02; };
  EXPECT_NEAR(gripper.inter_finger_dist_range().lower, apart(0.015), 1e-3);
  EXPECT_NEAR(gripper.inter_finger_dist_range().upper, apart(0.045), 1e-3);
  std::vector<double> ctrl(3);
  gripper.CtrlForOpening(1, ctrl);
  EXPECT_THAT(ctrl, ::testing::ElementsAre(0.03, -0.03, 0.03));
  gripper.CtrlForOpening(0, ctrl);
  EXPECT_THAT(ctrl, ::testing::ElementsAre(0, 0, 0));
}

TEST_F(GripperKinds, ThreeFingersHoldACubeBetweenThem) {
  RobotConfig config{.name = "hand",
                     .model = folder_.Write("hand", ThreeFingers()),
                     .move_groups = {{"gripper", ThreeFingerGroup()}}};
  config.move_groups.at("gripper").kind = MoveGroupKind::kGripper;
  SceneSpec spec = SceneWith({.name = "hand", .config = config});
  spec.gravity = {0, 0, 0};
  spec.objects.push_back(BoxObject("cube", {0, 0, 0.53}));
  Scene scene = Scene::Build(spec);
  scene.Reset();
  Robot robot = Robot::Of(scene, "hand");
  robot.Apply({{"gripper", GroupCommand::Opening(1)}});
  Simulate(robot, 0.5);
  scene.SetBodyPose("cube", Pose({0, 0, 0.53}, Quaternion{0, 0, 0, 1}));
  EXPECT_FALSE(robot.gripper().is_grasping("cube"));
  robot.Apply({{"gripper", GroupCommand::Opening(0)}});
  Simulate(robot, 1);
  EXPECT_TRUE(robot.gripper().is_grasping("cube"));
  EXPECT_FALSE(robot.gripper().is_open());
}

// Light fingers on a strongly damped servo that reaches its force limit in every timestep.
TEST_F(GripperKinds, OscillatingFingersAreReportedWithACureThatWorks) {
  const auto hand = [](const std::string& joint) {
    return fmt::format(
        "<option timestep=\".002\"/><worldbody><body name=\"palm\"><geom size=\".01\" "
        "contype=\"0\" "
        "conaffinity=\"0\"/><body name=\"left\" pos=\"0 .05 0\"><joint name=\"left\" "
        "type=\"slide\" "
        "axis=\"0 1 0\" range=\"-.04 .04\" {0}/><geom type=\"box\" size=\".01 .005 .03\" "
        "mass=\".01\"/></body><body name=\"right\" pos=\"0 -.05 0\"><geom type=\"box\" "
        "size=\".01 .005 .03\"/></body></body></worldbody><actuator><position name=\"grip\" "
        "joint=\"left\" kp=\"20000\" kv=\"200\" forcerange=\"-40 40\" ctrlrange=\"-.04 .04\"/>"
        "</actuator>",
        joint);
  };
  const MoveGroupConfig group{
      .joints = {"left"}, .actuators = {"grip"}, .fingers = {{.name = "left"}, {.name = "right"}}};
  Robot robot = Hand(hand("damping=\"0\""), group);
  std::string message;
  try {
    robot.gripper().inter_finger_dist_range();
  } catch (const ArgumentError& error) {
    message = error.what();
  }
  EXPECT_THAT(message,
              AllOf(HasSubstr("the fingers do not come to rest"),
                    HasSubstr("Joint 'left' oscillates: what drives it is too stiff for the "
                              "inertia that it moves at a timestep of 0.002 s. In a trial "
                              "`edits: [{joint: 'left', armature: ")));
  const std::string before = "{joint: 'left', armature: ";
  const size_t at = message.find(before) + before.size();
  const std::string armature = message.substr(at, message.find('}', at) - at);
  Robot cured = Hand(hand("armature=\"" + armature + "\""), group);
  EXPECT_NEAR(cured.gripper().inter_finger_dist_range().upper, 0.13, 5e-3);
}

}  // namespace
}  // namespace robocell::internal
