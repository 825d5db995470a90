#include "robocell/robot/robot_trial.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::StartsWith;

// A horizontal bar on a hinge: gravity pulls with 1 kg * g * 0.25 m = 2.45 N m.
class RobotTrial : public ::testing::Test {
 protected:
  std::vector<std::string> Doubts(const std::string& servo, const std::string& fields = "",
                                  const std::string& rest = "", const std::string& joint = "") {
    const std::string model = folder_.Write(
        "bar", fmt::format(R"(<compiler angle="radian"/><worldbody><body name="post" pos="0 0 1">
<geom size="0.02" pos="0 0 -0.5"/><body name="bar"><joint name="hip" axis="0 1 0" range="-2 2" {}/>
<geom type="capsule" size="0.02" fromto="0.02 0 0 0.48 0 0" mass="1"/><site name="tip" pos="0.5 0 0"/>
</body>{}</body></worldbody><actuator><position name="drive" joint="hip" {}/></actuator>)",
                           joint, rest, servo));
    AtomicWrite(file_,
                "name: bar\nmodel: " + model +
                    "\nmove_groups:\n  arm: {kind: arm, joints: [hip], leaf: {site: tip}}\n" +
                    fields);
    return TryRobot(RobotAlone(RobotConfig::Load(file_)));
  }

  ModelFolder folder_;
  const std::string file_ = (folder_.path() / "bar.yaml").string();
};

// A jaw on a hinge in the hand, its knuckle `gap` metres from the palm.
class JawTrial : public ::testing::Test {
 protected:
  RobotConfig Config(double gap, const char* fingers) {
    const std::string model =
        folder_.Write("jaw", fmt::format(R"(<compiler angle="radian"/><worldbody><body name="post">
<geom size="0.02" pos="0 0 -0.5"/><body name="hand"><joint name="roll" axis="0 0 1" range="-2 2"/>
<geom type="box" size="0.02 0.01 0.01" mass="1"/><site name="tip" pos="0 0 0.1"/>
<geom name="still" type="box" size="0.004 0.01 0.03" pos="0.02 0 0.06"/>
<site name="still" pos="0.02 0 0.09"/>
<body name="jaw" pos="-0.01 0 {}"><joint name="jaw" axis="0 1 0" range="-1.2 0" damping="0.05"/>
<geom type="box" size="0.008 0.01 0.008" mass="0.02"/><site name="moves" pos="0 0 0.07"/>
<geom name="moves" type="box" size="0.004 0.01 0.03" pos="0 0 0.04" mass="0.02"/></body>
</body></body></worldbody><actuator><position name="drive" joint="roll" kp="200" kv="20"/>
<position name="grip" joint="jaw" kp="20" kv="1" ctrlrange="-1.2 0"/></actuator>)",
                                         0.018 + gap));
    AtomicWrite(file_, fmt::format("name: jaw\nmodel: {}\nmove_groups:\n"
                                   "  arm: {{kind: arm, joints: [roll], leaf: {{site: tip}}}}\n"
                                   "  gripper: {{kind: gripper, joints: [jaw], actuators: grip, "
                                   "fingers: {}}}\n",
                                   model, fingers));
    return RobotConfig::Load(file_);
  }
  ModelFolder folder_;
  const std::string file_ = (folder_.path() / "jaw.yaml").string();
  const std::string tips_ =
      "'jaw' turns about a hinge in 'hand', and the two are nearest at the hinge, however far "
      "their tips are apart: name the tips of both as `fingers`, geoms or sites (edits: "
      "[{add_site: tip, body: jaw, pos: [...]}] adds one)";
};

TEST_F(JawTrial, FingersThatAreNearestAtTheirHingeAreToldToBeNamedByTheirTips) {
  EXPECT_THAT(TryRobot(RobotAlone(Config(0.002, "[{body: hand}, {body: jaw}]"))),
              Contains(HasSubstr("move_groups.gripper.fingers: " + tips_)));
  for (const char* tips : {"[{geom: still}, {geom: moves}]", "[{site: still}, {site: moves}]",
                           "[{geom: moves}, {site: still}]"}) {
    EXPECT_THAT(TryRobot(RobotAlone(Config(0.002, tips))), Not(Contains(HasSubstr("hinge"))))
        << tips;
  }
}

TEST_F(JawTrial, FingersThatOverlapAtTheirHingeAreToldToo) {
  Robot robot = RobotAlone(Config(-0.004, "[{body: hand}, {body: jaw}]"));
  ExpectThrow<ArgumentError>([&] { robot.gripper().opening(); },
                             "the finger distance stays at 0.0000 m between control 0 and -1.2; "
                             "are `fingers` and `ctrl` right? " +
                                 tips_);
}

TEST_F(RobotTrial, ShippedRobotsDoWhatTheyAreTold) {
  const auto doubts = [](const char* file) {
    const Robot robot = RobotAlone(LoadShipped(file));
    std::vector<std::string> all = robot.scene().compiled()->warnings();
    for (std::string& doubt : TryRobot(robot)) all.push_back(std::move(doubt));
    return all;
  };
  EXPECT_THAT(doubts("models/robots/rc7/rc7.yaml"), IsEmpty());
  EXPECT_THAT(doubts("examples/desk6/desk6.yaml"), IsEmpty());
  for (const auto& [file, model] : {std::pair{"xarm7.yaml", "ufactory_xarm7"},
                                    {"panda.yaml", "franka_emika_panda"},
                                    {"fr3_2f85.yaml", "franka_fr3"},
                                    {"gen3_2f85.yaml", "kinova_gen3"}}) {
    REQUIRE_MENAGERIE(model);
    EXPECT_THAT(doubts((std::string("examples/") + file).c_str()), IsEmpty()) << file;
  }
}

TEST_F(RobotTrial, AStrongServoIsNotSpokenOf) {
  EXPECT_THAT(Doubts("kp='2000' kv='100'"), IsEmpty());
  EXPECT_THAT(Doubts("kp='50' kv='5'", "gravcomp: true\n"), IsEmpty());
}

TEST_F(RobotTrial, ActuatorsOfNoGroupAreNamed) {
  const std::string more =
      "kp='2000' kv='100'/><motor name='spare' joint='hip'/><motor name='thruster' site='tip'";
  EXPECT_THAT(Doubts(more),
              ElementsAre(AllOf(StartsWith(file_ + ":4:"),
                                HasSubstr("move_groups: no move group has the actuators spare, "
                                          "thruster: nothing will command them"))));
  EXPECT_THAT(Doubts("kp='2000' kv='100'", "control: {arm: joint_torque}\ngravcomp: true\n"),
              Not(Contains(HasSubstr("no move group"))));
}

TEST_F(RobotTrial, ActuatorsOfSeveralInputsAreNamedOnce) {
  const std::string more =
      "kp='2000' kv='100'/><pid name='spare' joint='spin' kp='1' kv='1' input='pos vel ff'/>"
      "<pid name='other' joint='spin' kp='1' kv='1' input='pos vel ff'";
  EXPECT_THAT(
      Doubts(more, "",
             "<body name='fan' pos='0 0 -0.9'><joint name='spin'/><geom size='0.01'/></body>"),
      ElementsAre(HasSubstr("no move group has the actuators spare, other: nothing")));
}

TEST_F(RobotTrial, AServoThatSagsUnderGravityIsToldHowMuchItNeeds) {
  EXPECT_THAT(Doubts("kp='50' kv='5'"),
              ElementsAre(AllOf(
                  StartsWith(file_ + ":4:8: move_groups.arm: joint 'hip' drifts by 0.04"),
                  HasSubstr(" rad in 1 s while it should hold home (up to 0.01 rad is "
                            "tolerated): its servo's stiffness is 50 N m/rad, and gravity pulls "
                            "with 2.45 N m at home (490 would do). Set `gravcomp: true` or "
                            "raise the servos' stiffness (`stiffness`, N m/rad)"))));
}

// What is set already is not advised.
TEST_F(RobotTrial, WhatIsSetIsLookedAt) {
  EXPECT_THAT(Doubts("kp='50' kv='5'", "stiffness: 60\n"),
              ElementsAre(AllOf(StartsWith(file_ + ":5:12: stiffness: joint 'hip' drifts by"),
                                HasSubstr("at home (490 would do). Set `gravcomp: true` or raise "
                                          "`stiffness` (60 is set)"))));
  EXPECT_THAT(Doubts("kp='50' kv='50'", "gravcomp: true\nstiffness: 1\n"),
              ElementsAre(AllOf(HasSubstr("joint 'hip' moves 0.00"),
                                HasSubstr(" of 0.1 rad when it is sent there from home and given "
                                          "2.5 s: its servo's stiffness is 1 N m/rad against a "
                                          "damping of 50, so that it takes 50 s (250 would do). "
                                          "Raise `stiffness` (1 is set)"),
                                Not(HasSubstr("gravcomp")))));
  EXPECT_THAT(
      Doubts("kp='50' kv='5'", "gravcomp: true\nstiffness: 1\ndamping: 20\n"),
      ElementsAre(HasSubstr("Lower `damping` (20 is set) or raise `stiffness` (1 is set)")));
}

TEST_F(RobotTrial, AServoThatIsTooWeakIsToldWithItsLimit) {
  EXPECT_THAT(Doubts("kp='500' kv='50' forcerange='-2 2'"),
              ElementsAre(AllOf(HasSubstr("joint 'hip' drifts by "),
                                HasSubstr(": its servo 'drive' pushes with all it may, 2 N m, and "
                                          "gravity asks for 2.45 at home. Give the servos larger "
                                          "forces (edits: [{actuator: NAME, forcerange: [-F, F]}], "
                                          "or `force_limit` for all), or set `gravcomp: true`"))));
  EXPECT_THAT(Doubts("kp='500' kv='50'", "gravcomp: true\nforce_limit: 0.001\n"),
              ElementsAre(AllOf(StartsWith(file_ + ":6:14: force_limit: joint 'hip' moves "),
                                HasSubstr("pushes with all it may, 0.001 N m. Raise `force_limit` "
                                          "(0.001 is set)"),
                                Not(HasSubstr("gravcomp")))));
}

TEST_F(RobotTrial, AServoThatMayNotBeSentThereIsToldWithItsRange) {
  EXPECT_THAT(
      Doubts("kp='500' kv='50' ctrlrange='-0.1 0.1'", "gravcomp: true\nhome: {arm: [0.3]}\n"),
      ElementsAre(
          HasSubstr("joint 'hip' drifts by 0.2 rad in 1 s while it should hold home "
                    "(up to 0.01 rad is tolerated): to be at 0.3 rad its servo 'drive' needs "
                    "the control 0.3, but its ctrlrange is [-0.1, 0.1]. Widen it (edits: "
                    "[{actuator: 'drive', ctrlrange: [LOWER, UPPER]}]) or choose another "
                    "`home`")));
}

// The scene warns of it by itself, with the numbers to write.
TEST_F(RobotTrial, AServoThatTheSceneWarnsOfIsToldOnce) {
  Doubts("kp='500' kv='50' ctrlrange='-0.1 0.1'", "gravcomp: true\nhome: {arm: [0.3]}\n");
  const Robot robot = RobotAlone(RobotConfig::Load(file_));
  EXPECT_THAT(robot.scene().compiled()->warnings(),
              ElementsAre(AllOf(HasSubstr("the servo 'drive' sends joint 'hip' from -0.1 to 0.1"),
                                HasSubstr("the way to home, 0.3, stops there"))));
  EXPECT_THAT(TryRobot(robot), ElementsAre(HasSubstr("joint 'hip' drifts by")));
  EXPECT_THAT(TryRobotBesideWarnings(robot), IsEmpty());
  Doubts("kp='500' kv='50' ctrlrange='-0.1 0.25'", "gravcomp: true\nhome: {arm: [0.3]}\n");
  const Robot near = RobotAlone(RobotConfig::Load(file_));  // too near for the scene to warn
  EXPECT_THAT(near.scene().compiled()->warnings(), IsEmpty());
  EXPECT_THAT(TryRobotBesideWarnings(near), ElementsAre(HasSubstr("joint 'hip' drifts by 0.05")));
}

// Neither gravity nor damping: what is measured, and nothing that would not help.
TEST_F(RobotTrial, AServoThatSomethingElseHoldsIsToldWithWhatIsMeasured) {
  EXPECT_THAT(
      Doubts("kp='500' kv='50'", "gravcomp: true\n", "",
             "frictionloss='60' solimpfriction='0.999 0.999 0.001'"),
      ElementsAre(AllOf(HasSubstr("joint 'hip' moves "),
                        HasSubstr(": its servo's stiffness is 500 N m/rad, it pushes with "),
                        HasSubstr(" N m and the joint is still 0.0"),
                        HasSubstr(" rad away. Look for what holds it (its limits, frictionloss, "
                                  "equality constraints, margins of geoms, other actuators) or "
                                  "raise the servos' stiffness"),
                        Not(HasSubstr("would do")))));
}

TEST_F(RobotTrial, WhatTouchesIsNamedBeforeStiffness) {
  const char* block = "<body name='block' pos='0.3 0 0'><geom type='box' size='.02 .1 .1'/></body>";
  const std::vector<std::string> doubts = Doubts("kp='500' kv='50'", "gravcomp: true\n", block);
  ASSERT_FALSE(doubts.empty());
  EXPECT_THAT(doubts[0],
              HasSubstr("home: 'bar' and 'block' touch at home: exclude the pair in the model"));
  for (size_t i = 1; i < doubts.size(); ++i)
    EXPECT_THAT(doubts[i],
                AllOf(HasSubstr("'bar' and 'block' touch"), Not(HasSubstr("stiffness"))));
}

TEST_F(RobotTrial, WhatIsWithinAMarginDoesNotTouch) {
  const char* block =
      "<body name='block' pos='0.3 0 0.05'><geom type='box' size='.02 .1 .02' "
      "margin='.0105'/></body>";
  EXPECT_THAT(Doubts("kp='500' kv='50'", "gravcomp: true\n", block), IsEmpty());
}

// Neither two objects of its scene nor the fingers of a closed gripper.
TEST_F(RobotTrial, ContactsAreThoseOfTheRobot) {
  Doubts("kp='500' kv='50'");
  const std::string gripper = folder_.Write("grip", kTwoFingerGripper);
  AtomicWrite(file_, "name: bar\nmodel: bar.xml\ngravcomp: true\nattachments: [{mjcf_path: " +
                         gripper + R"(, attach_to: {site: tip}}]
move_groups:
  arm: {kind: arm, joints: [hip], leaf: {site: tip}}
  gripper: {kind: gripper, joints: [left_slide, right_slide], actuators: [grip],
            fingers: [left_pad, right_pad], ctrl: {open: 255, closed: 0}}
home: {arm: [0], gripper: [0.004, 0.004]}
)");
  SceneSpec spec = SceneWith({.name = "bar", .config = RobotConfig::Load(file_)});
  spec.objects = {BoxObject("low", {1, 1, 0.02}), BoxObject("high", {1, 1, 0.059})};
  const Scene scene = Scene::Build(spec);
  std::set<std::string> touching;
  for (const Contact& contact : scene.contacts()) touching.insert(contact.body2);
  EXPECT_THAT(touching, IsSupersetOf({"right", "high"})) << "else this tests nothing";
  EXPECT_THAT(TryRobot(Robot::Of(scene, "bar")), IsEmpty());
}

TEST_F(RobotTrial, AnArmOfTorquesIsHeldOnly) {
  EXPECT_THAT(Doubts("kp='2000' kv='100'", "control: {arm: joint_torque}\n"), IsEmpty());
}

// At run time too: a servo that is sent beyond its ctrlrange, a motor beyond its force.
TEST_F(RobotTrial, CommandsThatAServoCutsOffAreToldOnce) {
  Doubts("kp='2000' kv='100' ctrlrange='-1 1' forcerange='-30 30'");
  Robot robot = RobotAlone(RobotConfig::Load(file_));
  std::vector<std::string> lines;
  const ScopedLogSink sink([&](LogLevel, std::string_view text) { lines.emplace_back(text); });
  for (int i = 0; i < 3; ++i) {
    robot.SetJntPosCmd(std::vector<double>{1.5});
    robot.Update();
  }
  EXPECT_EQ(robot.arm().ctrl()[0], 1);
  EXPECT_THAT(lines,
              ElementsAre("robot 'bar' / group 'arm': actuator 'drive', by its ctrlrange, is "
                          "commanded to 1.5, beyond [-1, 1]; the nearest value inside is "
                          "used (said once)"));
  lines.clear();
  robot.set_ctrl_mode(CtrlMode::kTorque);
  for (int i = 0; i < 3; ++i) {
    robot.SetJntTrqCmd(std::vector<double>{-500});
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_NEAR(robot.jnt_trq_msr()[0], -30, 1e-9);
  EXPECT_THAT(lines,
              ElementsAre("robot 'bar' / group 'arm': the torque of joint 'hip' is commanded "
                          "to -500, beyond [-30, 30]; the nearest value inside is used (said "
                          "once)"));
}

}  // namespace
}  // namespace robocell
