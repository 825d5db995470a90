// What the engine takes without a word: ranges that contradict each other, radians that were read
// as degrees, fingers that touch nothing, cameras far away, what a model's file names and has not.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

struct ModelText {
  std::string angle = "radian", hip = "-2 2", knee = "-2.5 2.5", hip_ctrl = "-2 2",
              knee_ctrl = "-2.5 2.5", finger = "", rest = "", servo = "knee";
};

class Ranges : public ::testing::Test {
 protected:
  // Joint hip is in line 3, knee in line 5, their servos are in lines 11 and 12.
  std::string Model(const ModelText& m = {}) {
    AtomicWrite(model_, fmt::format(R"(<mujoco><compiler angle="{}"/><worldbody><body name="base">
<geom size="0.05"/><body name="upper" pos="0 0 0.1">
<joint name="hip" axis="0 1 0" range="{}"/>
<geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.3"/><body name="fore" pos="0 0 0.3">
<joint name="knee" axis="0 1 0" range="{}"/><geom size="0.02" mass="0.5"/><site name="tip" pos="0 0 0.1"/>
<body name="left" pos="0 0.05 0.05"><joint name="l" type="slide" axis="0 1 0" range="-0.04 0"/>
<geom type="box" size="0.01 0.004 0.02" {}/></body>
<body name="right" pos="0 -0.05 0.05"><joint name="r" type="slide" axis="0 -1 0" range="-0.04 0"/>
<geom type="box" size="0.01 0.004 0.02"/></body></body></body></body></worldbody>
<equality><joint joint1="l" joint2="r"/></equality><actuator>
<position name="s1" joint="hip" kp="100" kv="10" ctrlrange="{}"/>
<position name="s2" joint="{}" kp="100" kv="10" ctrlrange="{}"/>
<position name="grip" joint="l" kp="100" kv="10" ctrlrange="-0.04 0"/></actuator>{}</mujoco>)",
                                    m.angle, m.hip, m.knee, m.finger, m.hip_ctrl, m.servo,
                                    m.knee_ctrl, m.rest));
    return model_;
  }

  // `fields` begin in line 6.
  std::vector<std::string> Warnings(const ModelText& m, const std::string& fields = "") {
    Model(m);
    return Build(fields).compiled()->warnings();
  }
  Scene Build(const std::string& fields = "") {
    AtomicWrite(file_,
                "name: arm\nmodel: arm.xml\nmove_groups:\n"
                "  arm: {kind: arm, joints: [hip, knee], leaf: {site: tip}}\n"
                "  hand: {kind: gripper, joints: [l, r], actuators: [grip]}\n" +
                    fields);
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "arm", .config = RobotConfig::Load(file_), .prefix = "a/"});
    return Scene::Build(spec);
  }

  ModelFolder folder_;
  const std::string model_ = (folder_.path() / "arm.xml").string();
  const std::string file_ = (folder_.path() / "arm.yaml").string();
};

TEST_F(Ranges, WhatFitsIsNotSpokenOf) {
  EXPECT_THAT(Warnings({}), IsEmpty());
  EXPECT_THAT(Warnings({.hip_ctrl = "-3 3"}), IsEmpty()) << "wider";
  EXPECT_THAT(Warnings({.hip = "-6.28 6.28", .hip_ctrl = "-6.28 6.28"}), IsEmpty());
  EXPECT_THAT(Warnings({.angle = "degree", .hip = "-115 115", .knee = "-140 140"}), IsEmpty());
  EXPECT_THAT(Warnings({}, "home_noise: {arm: [0.1], hand: [0.01]}\n"), IsEmpty());
}

TEST_F(Ranges, AServoThatStopsBeforeItsJoint) {
  EXPECT_THAT(
      Warnings({.hip_ctrl = "-0.5 2"}),
      ElementsAre(model_ + ":11: robot 'arm': the servo 's1' sends joint 'hip' from -0.5 to 2 rad "
                           "(its ctrlrange), but the joint may move from -2 to 2 rad: commands "
                           "beyond stop there. To use all of it: edits: [{actuator: 's1', "
                           "ctrlrange: [-2, 2]}]"));
  EXPECT_THAT(Warnings({.hip_ctrl = "2.5 3"}),
              ElementsAre(AllOf(HasSubstr("from 2.5 to 3 rad"),
                                HasSubstr("it is driven against its limit, and so does the way to "
                                          "home, 0"))));
  EXPECT_THAT(Warnings({.hip_ctrl = "-0.5 0.5"}, "home: {arm: [1, 0]}\n"),
              ElementsAre(HasSubstr("stop there, and so does the way to home, 1")));
}

TEST_F(Ranges, RadiansThatWereReadAsDegrees) {
  EXPECT_THAT(
      Warnings({.angle = "degree"}),
      ElementsAre(AllOf(StartsWith(model_ + ":"),
                        HasSubstr("robot 'arm': no hinge of the arm moves farther than 5.0 degrees "
                                  "(joint 'knee': -0.04363 to 0.04363 rad, while its servo takes "
                                  "-2.5 to 2.5). Were radians read as degrees? They are degrees "
                                  "unless the model says <compiler angle=\"radian\"/>"))));
}

TEST_F(Ranges, DegreesThatWereReadAsRadians) {
  EXPECT_THAT(
      Warnings({.hip = "-170 170"}),
      ElementsAre(model_ + ":3: robot 'arm': joint 'hip' may turn from -170 to 170 rad, 54 times "
                           "around. Are these degrees? Then: the model says <compiler "
                           "angle=\"radian\"/>; 170 degrees are 2.9671"));
  const auto edited = Warnings({}, "edits: [{joint: hip, range: [-170, 170]}]\n");
  EXPECT_THAT(edited, ElementsAre(AllOf(StartsWith(file_ + ":6:29: robot 'arm': joint 'hip' may"),
                                        HasSubstr("in radians: [-2.9671, 2.9671]"))));
}

TEST_F(Ranges, TheLargerNumberFirst) {
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

TEST_F(Ranges, NoiseThatLeavesTheRange) {
  const auto warnings = Warnings({}, "home: {arm: [1.9, 0]}\nhome_noise: {arm: [0.2, 0.1]}\n");
  EXPECT_THAT(warnings,
              ElementsAre(file_ + ":7:19: robot 'arm': home_noise.arm: 0.2 rad around home, 1.9, "
                                  "leaves the range of joint 'hip', -2 to 2: what is beyond is put "
                                  "at its limit. Up to 0.1 stays inside"));
}

TEST_F(Ranges, AFingerThatTouchesNothing) {
  EXPECT_THAT(Warnings({.finger = "contype=\"0\" conaffinity=\"0\""}),
              ElementsAre(AllOf(StartsWith(file_ + ":5:33: robot 'arm': move_groups.hand.joints: "),
                                HasSubstr("no geom of the finger 'left' collides (their contype "
                                          "and conaffinity are 0), so it can hold nothing"))));
}

TEST_F(Ranges, ACameraFarAway) {
  const char* camera =
      "cameras:\n  - {{name: eye, attach_to: {{body: {}}}, pos: [{}, 0, 0], fovy: "
      "60}}\n";
  EXPECT_THAT(Warnings({}, fmt::format(fmt::runtime(camera), "fore", 0.3)), IsEmpty());
  EXPECT_THAT(Warnings({}, fmt::format(fmt::runtime(camera), "base", 2.5)), IsEmpty());
  EXPECT_THAT(Warnings({}, fmt::format(fmt::runtime(camera), "fore", 80)),
              ElementsAre(AllOf(StartsWith(file_ + ":7:"),
                                HasSubstr("robot 'arm' / camera 'eye': is 79.8 m away from the "
                                          "robot, which is 0."),
                                HasSubstr("m large: `pos` is in metres, in the frame of what it "
                                          "is attached to"))));
}

TEST_F(Ranges, AnActuatorOfAJointThatIsNotThere) {
  Model({.servo = "kne"});
  ExpectThrow<SpecError>([&] { Build(); },
                         "arm.yaml:2:8: robot 'arm': " + model_ +
                             ":12: the target of actuator 's2': no joint 'kne'. Its joints: hip, "
                             "knee, l, r. Did you mean 'knee'?");
}

TEST_F(Ranges, AKeyframeOfAnotherModel) {
  Model({.rest = "<keyframe><key name=\"home\" qpos=\"0 0.5\"/></keyframe>"});
  ExpectThrow<SpecError>([&] { Build(); },
                         model_ +
                             ": the keyframe 'home' has 2 numbers in qpos, and the model's "
                             "joints need 4, in this order: hip, knee, l, r");
}

TEST_F(Ranges, AUrdfIsNoRobotsModel) {
  AtomicWrite(folder_.path() / "arm.xml",
              "<?xml version=\"1.0\"?>\n<!-- <mujoco/> -->\n<robot name=\"r\"><link name=\"a\"/>"
              "</robot>");
  const std::string text = ExpectThrow<SpecError>([&] { Build(); },
                                                  "arm.xml is a URDF, and robots "
                                                  "are read from MJCF");
  EXPECT_THAT(
      text, AllOf(HasSubstr("arm.yaml:2:8: robot 'arm': "), HasSubstr("mujoco.MjSpec.from_file('"),
                  HasSubstr("arm.mjcf.xml', 'w')"),
                  HasSubstr("<position joint=... kp=... kv=.../>"), Not(HasSubstr("site "))));
}

}  // namespace
}  // namespace robocell
