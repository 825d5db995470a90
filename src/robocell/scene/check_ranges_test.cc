// What the engine takes without a word: ranges that contradict each other, radians that were read
// as degrees, fingers that touch nothing, cameras far away, what a model's file names and has not.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

struct ModelText {
  std::string angle = "radian", hip = "-2 2", knee = "-2.5 2.5", hip_ctrl = "-2 2",
              knee_ctrl = "-2.5 2.5", finger = "", rest = "", servo = "knee", first = "";
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
<equality><joint joint1="l" joint2="r"/></equality>{}<actuator>
<position name="s1" joint="hip" kp="100" kv="10" ctrlrange="{}"/>
<position name="s2" joint="{}" kp="100" kv="10" ctrlrange="{}"/>
<position name="grip" joint="l" kp="100" kv="10" ctrlrange="-0.04 0"/></actuator>{}</mujoco>)",
                                    m.angle, m.hip, m.knee, m.finger, m.first, m.hip_ctrl, m.servo,
                                    m.knee_ctrl, m.rest));
    return model_;
  }

  // `fields` begin in line 6.
  std::vector<std::string> Warnings(const ModelText& m, const std::string& fields = "") {
    Model(m);
    return Build(fields).compiled()->warnings();
  }
  Scene Build(const std::string& fields = "", const std::string& of_arm = "") {
    AtomicWrite(file_,
                "name: arm\nmodel: arm.xml\nmove_groups:\n"
                "  arm: {kind: arm, joints: [hip, knee], leaf: {site: tip}" +
                    of_arm + "}\n  hand: {kind: gripper, joints: [l, r], actuators: [grip]}\n" +
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

TEST_F(Ranges, AServoThatHardlyMovesOrIsNotAtHome) {
  EXPECT_THAT(
      Warnings({.hip_ctrl = "-0.035 0.035"}),
      ElementsAre(model_ + ":11: robot 'arm': the servo 's1' sends joint 'hip' from -0.035 to "
                           "0.035 rad (its ctrlrange), but the joint may move from -2 to 2 rad: it "
                           "hardly moves. To use all of it: edits: [{actuator: 's1', ctrlrange: "
                           "[-2, 2]}]"));
  EXPECT_THAT(Warnings({.hip_ctrl = "2.5 3"}),
              ElementsAre(AllOf(HasSubstr("from 2.5 to 3 rad"),
                                HasSubstr("it is driven against its limit, and the way to home, 0, "
                                          "stops there"))));
  EXPECT_THAT(Warnings({.hip_ctrl = "-0.5 0.5"}, "home: {arm: [1, 0]}\n"),
              ElementsAre(HasSubstr("commands beyond stop there, and the way to home, 1, stops")));
}

TEST_F(Ranges, AServoThatStopsBeforeItsJointIsANote) {
  Model({.hip_ctrl = "-0.5 2", .knee_ctrl = "-2.25 2.25"});
  const Scene scene = Build();
  EXPECT_THAT(scene.compiled()->warnings(), IsEmpty());
  EXPECT_THAT(scene.compiled()->notes(),
              ElementsAre("robot 'arm': servos of 'arm' stop before their joints do (their "
                          "ctrlrange): s1 -0.5 to 2 of -2 to 2, s2 -2.25 to 2.25 of -2.5 to 2.5"));
}

TEST_F(Ranges, ControlsInDegrees) {
  EXPECT_THAT(Warnings({.knee_ctrl = "-143 143"}),
              ElementsAre(model_ + ":12: robot 'arm': the servo 's2' takes -143 to 143 rad for "
                                   "joint 'knee' (its ctrlrange), which may move from -2.5 to 2.5 "
                                   "rad. Are these degrees? The engine converts joints' ranges, "
                                   "never ctrlrange: edits: [{actuator: 's2', ctrlrange: [-2.5, "
                                   "2.5]}]"));
  EXPECT_THAT(Warnings({.knee_ctrl = "-7 7"}), IsEmpty());
}

TEST_F(Ranges, OnlyTheServosThatTheArmIsDrivenBy) {
  const std::string fine =
      "<actuator><position name=\"s0\" joint=\"hip\" ctrlrange=\"0.1 0.2\"/></actuator>";
  Model({.first = fine});
  EXPECT_THAT(Build("", ", actuators: [s1, s2]").compiled()->warnings(), IsEmpty());
  EXPECT_THAT(Build().compiled()->warnings(), ElementsAre(HasSubstr("the servo 's0' sends")));
  EXPECT_THAT(Warnings({.hip_ctrl = "1 2"}, "control: {arm: joint_torque}\n"), IsEmpty());
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

TEST_F(Ranges, RadiansOfTheFingersOfAToolThatWereReadAsDegrees) {
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

TEST_F(Ranges, RadiansOfOneHingeThatWereReadAsDegrees) {
  const ModelText one = {.angle = "degree", .hip = "-115 115", .knee = "-2.9 2.9"};
  EXPECT_THAT(
      Warnings(one),
      ElementsAre(model_ + ":5: robot 'arm': joint 'knee' moves from -2.9 to 2.9 degrees "
                           "only, while other hinges of the arm move farther. Are these "
                           "radians? The model's angles are degrees: write \"-166.2 166.2\", "
                           "or, where they are meant, leave it"));
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

TEST_F(Ranges, AGripperTooWeakToHoldAnything) {
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

TEST_F(Ranges, DegreesThatWereReadAsRadians) {
  EXPECT_THAT(Warnings({.hip = "-170 170"}),
              ElementsAre(model_ +
                          ":3: robot 'arm': joint 'hip' may turn from -170 to 170 rad, 54 times "
                          "around. Are these degrees? Then write radians (170 degrees are 2.9671), "
                          "or leave angle=\"radian\" out of the model's <compiler>"));
  const auto edited = Warnings({}, "edits: [{joint: hip, range: [-170, 170]}]\n");
  EXPECT_THAT(edited, ElementsAre(AllOf(StartsWith(file_ + ":6:29: robot 'arm': joint 'hip' may"),
                                        HasSubstr("in radians: [-2.9671, 2.9671]"))));
}

TEST_F(Ranges, JointsThatTurnManyTimes) {
  EXPECT_THAT(Warnings({.hip = "-50 50", .hip_ctrl = "-50 50"}), IsEmpty()) << "a winch";
  EXPECT_THAT(Warnings({.hip = "-1e6 1e6"}), IsEmpty()) << "without end";
  EXPECT_THAT(Warnings({.hip = "-720 720"}), ElementsAre(HasSubstr("Are these degrees?")));
  EXPECT_THAT(Warnings({.hip = "-170 170", .hip_ctrl = "0 0\" inheritrange=\"1"}),
              ElementsAre(HasSubstr("Are these degrees?")))
      << "the servo only repeats the joint";
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
              ElementsAre(AllOf(
                  StartsWith(file_ + ":7:"),
                  HasSubstr("robot 'arm' / camera 'eye': camera 'eye' is 79.8 m away from the "
                            "robot, which is 0."),
                  HasSubstr("m large: `pos` is in metres, in the frame of what it "
                            "is attached to"))));
}

TEST_F(Ranges, ACameraOfTheModelsOwnMayBeAnywhere) {
  Model({.finger = "/><camera name=\"view\" pos=\"5 0 0\"/><camera name=\"follow\" "
                   "mode=\"trackcom\" pos=\"0 5 0\"/><geom size=\"0.001\""});
  EXPECT_THAT(Build().compiled()->warnings(), IsEmpty());
  EXPECT_THAT(Build("edits: [{camera: follow, pos: [0, 6, 0]}, {camera: view, fovy: 50}]\n")
                  .compiled()
                  ->warnings(),
              IsEmpty());
  EXPECT_THAT(Build("edits: [{camera: view, pos: [80, 0, 0]}]\n").compiled()->warnings(),
              ElementsAre(AllOf(StartsWith(file_ + ":6:"),
                                HasSubstr("robot 'arm' / edits[0]: camera 'view' is "))));
}

TEST_F(Ranges, AnActuatorOfAJointThatIsNotThere) {
  Model({.servo = "kne"});
  ExpectThrow<SpecError>([&] { Build(); },
                         "arm.yaml:2:8: robot 'arm': " + model_ +
                             ":12: the target of actuator 's2': no joint 'kne'. Its joints: hip, "
                             "knee, l, r. Did you mean 'knee'?");
}

TEST_F(Ranges, AKeyframeOfAnotherModel) {
  Model({.rest = "<keyframe><key name=\"home\" qpos=\"0 0.5 0 0 1\"/></keyframe>"});
  EXPECT_THROW(Compile(ParseXmlFile(model_).get()), SpecError);
  ExpectThrow<SpecError>([&] { Build(); },
                         model_ +
                             ": the keyframe 'home' has 5 numbers in qpos, and the model's "
                             "joints need 4, in this order: hip, knee, l, r");
}

// The engine completes the keyframe, here of a model that another one is attached to; it is the
// oracle.
TEST_F(Ranges, AKeyframeOfTheOwnJointsOnly) {
  AtomicWrite(folder_.path() / "tool.xml",
              "<mujoco model=\"tool\"><worldbody><body name=\"t\"><joint name=\"spin\"/>"
              "<geom size=\"0.02\" mass=\"0.1\"/></body></worldbody></mujoco>");
  Model({.rest =
             "<asset><model name=\"tool\" file=\"tool.xml\"/></asset><worldbody><body name=\"c\">"
             "<attach model=\"tool\" body=\"t\" prefix=\"t_\"/></body></worldbody>"
             "<keyframe><key name=\"home\" qpos=\"0.1 0.5\"/></keyframe>"});
  const ModelPtr alone = Compile(ParseXmlFile(model_).get());
  ASSERT_EQ(alone->nq, 5);
  const Scene scene = Build("root_body: base\n");
  EXPECT_THAT(scene.compiled()->warnings(),
              Contains(model_ + ": robot 'arm': the keyframe 'home' has 2 numbers in qpos, and the "
                                "model's joints need 5, in this order: hip, knee, l, r, t_spin. "
                                "Without a number, and at their reference: l, r, t_spin"));
  const mjModel* model = scene.model();
  const int home = scene.compiled()->home_key();
  for (const std::string joint : {"hip", "knee", "l", "r"}) {
    const int own = FindId(alone.get(), mjOBJ_JOINT, joint);
    const int there = FindId(model, mjOBJ_JOINT, "a/" + joint);
    EXPECT_EQ(model->key_qpos[home * model->nq + model->jnt_qposadr[there]],
              alone->key_qpos[alone->jnt_qposadr[own]])
        << joint;
  }
}

TEST_F(Ranges, AKeyframeWithTooFewControls) {
  Model({.rest = "<keyframe><key name=\"home\" qpos=\"0 0.5 0 0\" ctrl=\"0\"/></keyframe>"});
  EXPECT_THAT(Build().compiled()->warnings(),
              ElementsAre(model_ + ": robot 'arm': the keyframe 'home' has 1 numbers in ctrl for 3 "
                                   "actuators. Without a number, and at the control that holds "
                                   "home: actuator 's2', actuator 'grip'"));
}

TEST_F(Ranges, KeyframesThatAreCalledOtherwiseAreNamedWithTheirNumbers) {
  Model({.rest = "<keyframe><key name=\"ready\" qpos=\"0.1 0.5 0 0\"/><key qpos=\"0 0 0 0\"/>"
                 "</keyframe>"});
  EXPECT_THAT(Build().compiled()->notes(),
              ElementsAre("robot 'arm': " + model_ +
                          " has no keyframe 'home', only 'ready', the 2. (unnamed): the robot "
                          "starts with all joints at their reference. To start at a keyframe, "
                          "write its numbers as `home`: 'ready' has hip 0.1, knee 0.5, l 0, "
                          "r 0"));
  EXPECT_THAT(Build("home: {arm: [0.1, 0.5]}\n").compiled()->notes(), IsEmpty());
}

TEST_F(Ranges, AHomeThatDegreesPutOutsideTheLimits) {
  Model(
      {.angle = "degree", .rest = "<keyframe><key name=\"home\" qpos=\"1.5 0 0 0\"/></keyframe>"});
  ExpectThrow<SpecError>([&] { Build(); },
                         "1.5 is outside the limits -0.0349066 to 0.0349066 of joint 'hip'. Were "
                         "radians read as degrees? The model's -2 to 2 are degrees unless it says "
                         "<compiler angle=\"radian\"/>");
}

// A model that is made to be looked at alone brings a floor. In its world it is left there; in a
// body it would come along.
TEST_F(Ranges, AFloorThatTheModelBrings) {
  const std::string plane = "geom name=\"ground\" type=\"plane\" size=\"0 0 1\"/>";
  Model({.first = "<worldbody><" + plane + "</worldbody>"});
  const Scene outside = Build();
  EXPECT_THAT(outside.compiled()->warnings(), IsEmpty());
  EXPECT_THAT(outside.compiled()->notes(), ElementsAre(HasSubstr("left out of its world: geom")));
  EXPECT_LT(FindId(outside.model(), mjOBJ_GEOM, "a/ground"), 0);

  SceneSpec spec = EmptyScene();
  spec.robots.push_back(
      {.path = folder_.Write("inside", "<worldbody><body name=\"base\"><" + plane +
                                           "<body><joint/><geom size=\"0.1\"/></body></body>"
                                           "</worldbody>")});
  EXPECT_THAT(
      Scene::Build(spec).compiled()->warnings(),
      Contains("robot 'robot': geom 'ground' of body 'base' is a plane without end: a second "
               "floor that goes where the body goes. If it is only there to look at the "
               "robot alone: edits: [{delete: {geom: ground}}]"));
}

TEST_F(Ranges, AUrdfMayBeAPassiveTool) {
  AtomicWrite(
      folder_.path() / "pen.urdf",
      "<robot name=\"pen\"><link name=\"pen\"><inertial><mass value=\"0.1\"/><inertia "
      "ixx=\"1e-4\" iyy=\"1e-4\" izz=\"1e-4\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>"
      "<collision><geometry><sphere radius=\"0.02\"/></geometry></collision></link></robot>");
  Model();
  const Scene scene =
      Build("attachments: [{mjcf_path: pen.urdf, attach_to: {site: tip}, prefix: pen_}]\n");
  EXPECT_GE(FindId(scene.model(), mjOBJ_BODY, "a/pen_pen"), 0);
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
