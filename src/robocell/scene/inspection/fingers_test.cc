// Tests fingers that cannot hold anything.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/scene/testing/arm_with_hand.h"
#include "robocell/scene/testing/robot_files.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

using FingerChecks = ArmWithHand;

TEST_F(FingerChecks, AGripperTooWeakToHoldObjects) {
  EXPECT_THAT(Warnings({}, "edits: [{actuator: grip, forcerange: [-0.2, 0.2]}]\n"), IsEmpty());
  EXPECT_THAT(
      Warnings({}, "edits: [{actuator: grip, forcerange: [-0.04, 0.04]}]\n"),
      ElementsAre(file_ +
                  ":5:52: robot 'arm': move_groups.hand.actuators: grip may push with 0.04 "
                  "at most, which is 0.04 N at joint 'l', and what hangs on it takes 0.0628 "
                  "to lift: the gripper can hold nothing. Raise the forcerange, or the "
                  "gains where that is not the limit (edits: [{actuator: 'grip', "
                  "forcerange: [-F, F]}])"));
}

TEST_F(FingerChecks, AFingerWithoutCollisionGeoms) {
  EXPECT_THAT(Warnings({.finger = "contype=\"0\" conaffinity=\"0\""}),
              ElementsAre(AllOf(StartsWith(file_ + ":5:33: robot 'arm': move_groups.hand.joints: "),
                                HasSubstr("no geom of the finger 'left' collides (their contype "
                                          "and conaffinity are 0), so it can hold nothing"))));
}

TEST_F(FingerChecks, AGripperWithoutIntermediateOpenings) {
  std::string text = ReadFile(Model());
  const std::string servo =
      R"(<position name="grip" joint="l" kp="100" kv="10" ctrlrange="-0.04 0"/>)";
  const auto notes = [&](const std::string& actuator, const std::string& joint = "") {
    std::string model = text;
    model.replace(model.find(servo), servo.size(), actuator);
    if (!joint.empty()) model.insert(model.find(R"(<joint name="l")") + 6, joint);
    AtomicWrite(model_, model);
    return Build().compiled()->notes();
  };
  const auto noted = [](const std::string& what) {
    return Contains(HasSubstr("gripper 'hand' only opens and closes: grip is a " + what +
                              ", and nothing holds its fingers in between"));
  };
  constexpr const char* kMotor = R"(<motor name="grip" joint="l" ctrlrange="-20 20"/>)";
  EXPECT_THAT(notes(kMotor), noted("motor, whose control is a force"));
  EXPECT_THAT(notes(R"(<velocity name="grip" joint="l" kv="10" ctrlrange="-.1 .1"/>)"),
              noted("velocity servo, whose control is a speed"));
  EXPECT_THAT(notes(kMotor, " stiffness=\"300\""), Not(noted("motor, whose control is a force")));
  EXPECT_THAT(notes(servo), Not(Contains(HasSubstr("only opens and closes"))));
}

using FingersOfFiles = RobotFiles;

TEST_F(FingersOfFiles, AnUndrivenFinger) {
  std::string gripper = kTwoFingerGripper;
  const std::string tie = R"(<joint joint1="left_slide" joint2="right_slide"/>)";
  const std::string tendon = R"(<joint joint="right_slide" coef="0.5"/>)";
  gripper.erase(gripper.find(tie), tie.size());
  const auto warnings = [&](const std::string& model, const std::string& fingers) {
    folder.Write("gripper", model);
    const Scene scene = BuildRobot(
        RobotFile("attachments: [{mjcf_path: gripper.xml, prefix: g_, attach_to: {site: flange}}]\n"
                  "move_groups:\n"
                  "  gripper: {kind: gripper, joints: [g_left_slide, g_right_slide], actuators: "
                  "g_grip" +
                  fingers + "}\n"));
    return scene.compiled()->warnings();
  };
  EXPECT_THAT(warnings(gripper, ""), IsEmpty()) << "the tendon moves both";
  gripper.erase(gripper.find(tendon), tendon.size());
  const std::string why =
      ": nothing moves the finger 'g_right': no actuator acts on its joint 'g_right_slide' and no "
      "equality ties it to the other finger. In the model, couple it (<equality><joint "
      "joint1=\"g_right_slide\" joint2=\"g_left_slide\"/></equality>) or give it an actuator";
  EXPECT_THAT(warnings(gripper, ""), ElementsAre("robot 'left': move_groups.gripper.joints" + why));
  EXPECT_THAT(warnings(gripper, ", fingers: [g_left_pad, g_right_pad]"),
              ElementsAre("robot 'left': move_groups.gripper.fingers" + why));
  std::string tied = gripper;
  tied.insert(tied.find("</equality>"), tie);
  EXPECT_THAT(warnings(tied, ""), IsEmpty());
}

}  // namespace
}  // namespace robocell
