// Tests ranges that contradict each other, radians that were read as degrees, and degrees as
// radians.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/scene/testing/arm_with_hand.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

using Ranges = ArmWithHand;

TEST_F(Ranges, AcceptsMatchingRanges) {
  EXPECT_THAT(Warnings({}), IsEmpty());
  EXPECT_THAT(Warnings({.hip_ctrl = "-3 3"}), IsEmpty()) << "wider";
  EXPECT_THAT(Warnings({.hip = "-6.28 6.28", .hip_ctrl = "-6.28 6.28"}), IsEmpty());
  EXPECT_THAT(Warnings({.angle = "degree", .hip = "-115 115", .knee = "-140 140"}), IsEmpty());
  EXPECT_THAT(Warnings({}, "home_noise: {arm: [0.1], hand: [0.01]}\n"), IsEmpty());
}

TEST_F(Ranges, RadiansParsedAsDegrees) {
  EXPECT_THAT(
      Warnings({.angle = "degree"}),
      ElementsAre(AllOf(StartsWith(model_ + ":"),
                        HasSubstr("robot 'arm': no hinge of the arm moves farther than 5.0 degrees "
                                  "(joint 'knee': -0.04363 to 0.04363 rad, while its servo takes "
                                  "-2.5 to 2.5). Were radians read as degrees? They are degrees "
                                  "unless the model says <compiler angle=\"radian\"/>"))));
}

TEST_F(Ranges, RadiansOfToolFingersParsedAsDegrees) {
  const auto hand = [&](const char* angle) {
    folder_.Write("hand", fmt::format(R"({}<worldbody><body name="palm">
      <geom size="0.01" mass="0.1"/>
      <body name="left" pos="0 0.02 0"><joint name="l" axis="1 0 0" range="0 0.8" limited="true"/>
        <geom type="capsule" size="0.005" fromto="0 0 0 0 0 0.05"/></body>
      <body name="right" pos="0 -0.02 0"><joint name="r" axis="-1 0 0" range="0 0.8" limited="true"/>
        <geom type="capsule" size="0.005" fromto="0 0 0 0 0 0.05"/></body></body></worldbody>
      <actuator><position name="l" joint="l" kp="1" kv="0.1" ctrlrange="0 0.8"/>
      <position name="r" joint="r" kp="1" kv="0.1" ctrlrange="0 0.8"/></actuator>)",
                                      angle));
    return Warnings({},
                    "  claw: {kind: gripper, joints: [g_l, g_r], actuators: [g_l, g_r]}\n"
                    "attachments: [{mjcf_path: hand.xml, attach_to: {site: tip}, prefix: g_}]\n");
  };
  EXPECT_THAT(hand("<compiler angle=\"radian\"/>"), IsEmpty());
  EXPECT_THAT(hand(""),
              ElementsAre(HasSubstr("no hinge of the gripper moves farther than 0.8 degrees (joint "
                                    "'g_r': 0 to 0.01396 rad, while its servo takes 0 to 0.8). "
                                    "Were radians read as degrees?")));
}

TEST_F(Ranges, RadiansOfOneHingeParsedAsDegrees) {
  const ModelText one = {.angle = "degree", .hip = "-115 115", .knee = "-2.9 2.9"};
  EXPECT_THAT(
      Warnings(one),
      ElementsAre(model_ + ":5: robot 'arm': joint 'knee' moves from -2.9 to 2.9 degrees "
                           "only, while other hinges of the arm move farther. Are these "
                           "radians? The model's angles are degrees: write \"-166.2 166.2\", "
                           "or, if they are correct, leave it"));
  EXPECT_THAT(Warnings({.knee = "-0.05 0.05"}), IsEmpty()) << "a model in radians";
  EXPECT_THAT(Warnings({.angle = "degree", .hip = "-115 115", .knee = "-10 10"}), IsEmpty());
  EXPECT_THAT(Warnings(one, "edits: [{joint: knee, range: [-0.05, 0.05]}]\n"), IsEmpty());
}

TEST_F(Ranges, AnEqualityAgainstTheRangesOfItsJoints) {
  const auto coupled = [&](const char* polycoef) {
    return Warnings(
        {.first = fmt::format(
             R"(<equality><joint joint1="l" joint2="r" polycoef="{}"/></equality>)", polycoef)});
  };
  EXPECT_THAT(coupled("0 1 0 0 0"), IsEmpty());
  EXPECT_THAT(coupled("0 .5 0 0 0"), IsEmpty());
  EXPECT_THAT(coupled("-.02 .5 0 0 0"), IsEmpty());
  EXPECT_THAT(
      coupled("0 -1 0 0 0"),
      ElementsAre(model_ + ":6: robot 'arm': the equality of joints 'l' and 'r' sends 'l' "
                           "from 0 to 0.04 m while 'r' moves through its range, -0.04 to 0, "
                           "but 'l' may move from -0.04 to 0, so neither moves. Has its "
                           "polycoef the wrong sign? \"0 1\" would fit"));
  EXPECT_THAT(coupled(".5 1 0 0 0"),
              ElementsAre(HasSubstr("so neither moves. Are its polycoef and the ranges right?")));
}

TEST_F(Ranges, DegreesParsedAsRadians) {
  EXPECT_THAT(Warnings({.hip = "-170 170"}),
              ElementsAre(model_ +
                          ":3: robot 'arm': joint 'hip' may turn from -170 to 170 rad, 54 times "
                          "around. Are these degrees? Then write radians (170 degrees are 2.9671), "
                          "or leave angle=\"radian\" out of the model's <compiler>"));
  const auto edited = Warnings({}, "edits: [{joint: hip, range: [-170, 170]}]\n");
  EXPECT_THAT(edited, ElementsAre(AllOf(StartsWith(file_ + ":6:29: robot 'arm': joint 'hip' may"),
                                        HasSubstr("in radians: [-2.9671, 2.9671]"))));
}

TEST_F(Ranges, JointsWithManyTurns) {
  EXPECT_THAT(Warnings({.hip = "-50 50", .hip_ctrl = "-50 50"}), IsEmpty()) << "a winch";
  EXPECT_THAT(Warnings({.hip = "-1e6 1e6"}), IsEmpty()) << "without end";
  EXPECT_THAT(Warnings({.hip = "-720 720"}), ElementsAre(HasSubstr("Are these degrees?")));
  EXPECT_THAT(Warnings({.hip = "-170 170", .hip_ctrl = "0 0\" inheritrange=\"1"}),
              ElementsAre(HasSubstr("Are these degrees?")))
      << "the servo only repeats the joint";
}

TEST_F(Ranges, ReversedRanges) {
  EXPECT_THAT(
      Warnings({.hip = "2 -2"}),
      ElementsAre(model_ + ":3: robot 'arm': the range of joint 'hip', 2 to -2, has the larger "
                           "number first, so it limits nothing: write \"-2 2\""));
  EXPECT_THAT(Warnings({.knee_ctrl = "2 -2"}),
              ElementsAre(AllOf(StartsWith(model_ + ":12: "),
                                HasSubstr("the ctrlrange of actuator 's2', 2 to -2, has the"))));
  Model();
  ExpectThrow<SpecError>([&] { Build("edits: [{joint: hip, range: [2, -2]}]\n"); },
                         "[2, -2] is [smallest, largest]; the first is larger");
}

TEST_F(Ranges, NoiseBeyondTheRange) {
  const auto warnings = Warnings({}, "home: {arm: [1.9, 0]}\nhome_noise: {arm: [0.2, 0.1]}\n");
  EXPECT_THAT(warnings,
              ElementsAre(file_ + ":7:19: robot 'arm': home_noise.arm: 0.2 rad around home, 1.9, "
                                  "leaves the range of joint 'hip', -2 to 2: larger values are "
                                  "clipped to the limit. Up to 0.1 stays inside"));
}

}  // namespace
}  // namespace robocell
