// Tests arms that do not hold home or do not follow, reported with the reason.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/diagnose/check_robot.h"
#include "robocell/diagnose/testing/bar.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

using ArmTrials = BarTrial;

TEST_F(ArmTrials, AcceptsAStrongServo) {
  EXPECT_THAT(Doubts("kp='2000' kv='100'"), IsEmpty());
  EXPECT_THAT(Doubts("kp='50' kv='5'", "gravcomp: true\n"), IsEmpty());
}

TEST_F(ArmTrials, ReportsTheStiffnessThatASaggingServoNeeds) {
  EXPECT_THAT(Doubts("kp='50' kv='5'"),
              ElementsAre(AllOf(
                  StartsWith(file_ + ":4:8: move_groups.arm: joint 'hip' drifts by 0.04"),
                  HasSubstr(" rad in 1 s while it should hold home (up to 0.01 rad is "
                            "tolerated): its servo's stiffness is 50 N m/rad, and gravity pulls "
                            "with 2.45 N m at home (490 would do). Set `gravcomp: true` or "
                            "raise the servos' stiffness (`stiffness`, N m/rad)"))));
}

// The advice leaves out settings that are already present.
TEST_F(ArmTrials, ReportsTheConfiguredStiffnessAndDamping) {
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

TEST_F(ArmTrials, WarnsAboutUndampedJoints) {
  EXPECT_THAT(Doubts("kp='500'", "gravcomp: true\n"),
              ElementsAre(AllOf(HasSubstr("joint 'hip' still swings by 0."),
                                HasSubstr(" rad around its target when it is sent there from home "
                                          "and given 2.5 s: nothing damps it. Give its servo "
                                          "damping (`damping`, N m s/rad)"))));
  EXPECT_THAT(Doubts("kp='500'", "gravcomp: true\ndamping: 1e-3\n"),
              ElementsAre(HasSubstr("Raise `damping` (0.001 is set)")));
}

// At its force limit the servo overshoots with every timestep, because the link is light. It is
// neither weak nor blocked, and the edit that was tried ends it.
TEST_F(ArmTrials, ReportsAnOscillatingServoWithACureThatWorks) {
  const auto doubts = [&](const std::string& edits) {
    const std::string model = folder_.Write("light", R"(<compiler angle="radian"/>
<worldbody><body name="post" pos="0 0 1"><geom size="0.02" pos="0 0 -0.5"/><body name="bar">
<joint name="hip" axis="0 1 0" range="-2 2"/><geom type="capsule" size="0.02"
fromto="0.02 0 0 0.1 0 0" mass="0.05"/><site name="tip" pos="0.1 0 0"/></body></body></worldbody>
<actuator><position name="drive" joint="hip" kp="5000" kv="50" forcerange="-2 2"/></actuator>)");
    AtomicWrite(file_, "name: light\nmodel: " + model + "\ngravcomp: true\n" + edits +
                           "move_groups:\n  arm: {kind: arm, joints: [hip], leaf: {site: tip}}\n");
    const Robot robot = RobotAlone(RobotConfig::Load(file_));
    return CheckRobot(robot);
  };
  std::vector<Finding> found = doubts("");
  std::erase_if(found, [](const Finding& f) { return f.severity == Severity::kNote; });
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].text,
              AllOf(HasSubstr("joint 'hip' oscillates by "), HasSubstr(" rad around its target"),
                    HasSubstr(": its servo 'drive' (kp 5e+03, kv 50) is too strong for the 0.00023 "
                              "kg m2 that the joint moves at a timestep of 0.002 s. In a trial "
                              "`edits: [{joint: 'hip', armature: "),
                    HasSubstr("and so did a timestep of ")));
  found = doubts("edits: [" + found[0].edit + "]\n");
  std::erase_if(found, [](const Finding& f) { return f.severity == Severity::kNote; });
  EXPECT_THAT(found, IsEmpty());
}

// Whatever the servo may push, and says: it is not too weak.
TEST_F(ArmTrials, SuggestsAnEditForAnExcessiveJointValue) {
  EXPECT_THAT(
      Doubts("kp='500' kv='50' forcerange='-2 2'",
             "gravcomp: true\nedits: [{joint: hip, damping: 1.0e+12}]\n"),
      ElementsAre(AllOf(
          HasSubstr(": its damping of 1e+12 is too large for its servo's "
                    "stiffness of 500 N m/rad"),
          HasSubstr("Lower the damping of the joint (edits: [{joint: 'hip', damping: 50}])"))));
  EXPECT_THAT(Doubts("kp='500' kv='50' forcerange='-2 2'",
                     "gravcomp: true\nedits: [{joint: hip, armature: 1.0e+9}]\n"),
              ElementsAre(HasSubstr("its armature of 1e+09 is too large for its servo's")));
}

TEST_F(ArmTrials, ReportsAnExcessiveKvAtItsServo) {
  EXPECT_THAT(Doubts("kp='500' kv='1e7' forcerange='-50 50'", "gravcomp: true\n"),
              ElementsAre(AllOf(HasSubstr(": the kv of its servo 'drive', 1e+07, is too large for "
                                          "its stiffness of 500 N m/rad"),
                                HasSubstr("Lower it in the model to 50"))));
}

TEST_F(ArmTrials, ReportsFrictionAboveTheForceOfAServo) {
  EXPECT_THAT(
      Doubts("kp='2000' kv='100' forcerange='-60 60'", "gravcomp: true\n", "",
             "frictionloss='100'"),
      ElementsAre(HasSubstr("only creeps when it is sent there from home and given 2.5 s: "
                            "its frictionloss of 100 is more than the 60 N m that its servo "
                            "'drive' may push with")));
}

TEST_F(ArmTrials, ReportsTheForceLimitOfAWeakServo) {
  EXPECT_THAT(Doubts("kp='500' kv='50' forcerange='-2 2'"),
              ElementsAre(AllOf(HasSubstr("joint 'hip' drifts by "),
                                HasSubstr(": its servo 'drive' pushes with all it may, 2 N m, and "
                                          "gravity needs 2.45 at home. Give the servos larger "
                                          "forces (edits: [{actuator: NAME, forcerange: [-F, F]}], "
                                          "or `force_limit` for all), or set `gravcomp: true`"))));
  EXPECT_THAT(Doubts("kp='500' kv='50'", "gravcomp: true\nforce_limit: 0.001\n"),
              ElementsAre(AllOf(StartsWith(file_ + ":6:14: force_limit: joint 'hip' moves "),
                                HasSubstr("pushes with all it may, 0.001 N m. Raise `force_limit` "
                                          "(0.001 is set)"),
                                Not(HasSubstr("gravcomp")))));
}

TEST_F(ArmTrials, ReportsAControlRangeThatExcludesHome) {
  EXPECT_THAT(
      Doubts("kp='500' kv='50' ctrlrange='-0.1 0.1'", "gravcomp: true\nhome: {arm: [0.3]}\n"),
      ElementsAre(
          HasSubstr("joint 'hip' drifts by 0.2 rad in 1 s while it should hold home "
                    "(up to 0.01 rad is tolerated): to be at 0.3 rad its servo 'drive' needs "
                    "the control 0.3, but its ctrlrange is [-0.1, 0.1]. Widen it (edits: "
                    "[{actuator: 'drive', ctrlrange: [LOWER, UPPER]}]) or choose another "
                    "`home`")));
}

// The scene itself warns of it, with the numbers to write.
TEST_F(ArmTrials, ReportsAServoOnceIfTheSceneWarnsAboutIt) {
  Doubts("kp='500' kv='50' ctrlrange='-0.1 0.1'", "gravcomp: true\nhome: {arm: [0.3]}\n");
  const Robot robot = RobotAlone(RobotConfig::Load(file_));
  EXPECT_THAT(robot.scene().compiled()->warnings(),
              ElementsAre(AllOf(HasSubstr("the servo 'drive' sends joint 'hip' from -0.1 to 0.1"),
                                HasSubstr("the way to home, 0.3, stops there"))));
  EXPECT_THAT(LinesOfRobot(robot), ElementsAre(HasSubstr("joint 'hip' drifts by")));
  EXPECT_THAT(LinesOfRobot(robot, {.beside_warnings = true}), IsEmpty());
  Doubts("kp='500' kv='50' ctrlrange='-0.1 0.25'", "gravcomp: true\nhome: {arm: [0.3]}\n");
  const Robot near = RobotAlone(RobotConfig::Load(file_));  // too near for the scene to warn
  EXPECT_THAT(near.scene().compiled()->warnings(), IsEmpty());
  EXPECT_THAT(LinesOfRobot(near, {.beside_warnings = true}),
              ElementsAre(HasSubstr("joint 'hip' drifts by 0.05")));
}

// Neither gravity nor damping: the finding has the measurement, and no useless advice.
TEST_F(ArmTrials, ReportsMeasurementsOfABlockedServo) {
  EXPECT_THAT(
      Doubts("kp='500' kv='50'", "gravcomp: true\n", "", "stiffness='500'"),
      ElementsAre(AllOf(
          HasSubstr("joint 'hip' moves "),
          HasSubstr(": its servo's stiffness is 500 N m/rad, it pushes with "),
          HasSubstr(" N m and the joint is still 0.0"),
          HasSubstr(" rad away. Check what blocks it (its limits, spring, "
                    "frictionloss, equality constraints, margins of geoms, other actuators) or "
                    "raise the servos' stiffness"),
          Not(HasSubstr("would do")))));
}

// A light hinge on a heavy slide: what one needs is wrong for the other.
class UnlikeJoints : public ::testing::Test {
 protected:
  struct Joints {
    const char *lift = "", *lift_servo = "kp='8000' kv='600'";
    const char *turn = "", *turn_servo = "kp='100' kv='6'";
    const char* fields = "gravcomp: true\n";
  };
  std::vector<std::string> Doubts(const Joints& joints, const std::string& edits = "") {
    const std::string model = folder_.Write(
        "gantry", fmt::format(R"(<compiler angle="radian"/><worldbody><body name="post" pos="0 0 1">
<geom size="0.02" pos="0 0 -0.9"/><body name="lift"><joint name="lift" type="slide" axis="0 0 1"
range="-0.5 0.5" {}/><geom type="box" size="0.05 0.05 0.05" mass="5"/><body name="wrist"
pos="0 0 -0.1"><joint name="turn" axis="0 0 1" range="-2 2" armature="0.01" {}/>
<geom type="box" size="0.03 0.02 0.01" mass="0.4"/><site name="tip"/></body></body></body>
</worldbody><actuator><position name="lifter" joint="lift" {}/><position name="turner" joint="turn"
{}/></actuator>)",
                              joints.lift, joints.turn, joints.lift_servo, joints.turn_servo));
    const std::string file = (folder_.path() / "gantry.yaml").string();
    AtomicWrite(file, "name: gantry\nmodel: " + model +
                          "\nmove_groups:\n  arm: {kind: arm, joints: [lift, turn], leaf: {site: "
                          "tip}}\n" +
                          joints.fields + edits);
    return LinesOfRobot(RobotAlone(RobotConfig::Load(file)));
  }
  // Expects one finding whose advice is `edit`, and none after following it.
  void ExpectRemedy(const Joints& joints, const std::string& what, const std::string& edit) {
    EXPECT_THAT(Doubts(joints), ElementsAre(AllOf(HasSubstr(what), HasSubstr(": [" + edit + "]"))));
    EXPECT_THAT(Doubts(joints, "edits: [" + edit + "]\n"), IsEmpty()) << edit;
  }
  ModelFolder folder_;
};

TEST_F(UnlikeJoints, GetTheGainOfTheirOwnServo) {
  EXPECT_THAT(Doubts({}), IsEmpty());
  ExpectRemedy(
      {.lift_servo = "kp='300' kv='600'", .fields = ""},
      "its servo's stiffness is 300 N/m, and gravity pulls with 53 N at home (110000 would "
      "do). Set `gravcomp: true` or raise the stiffness of its servo (edits",
      "{actuator: 'lifter', kp: 110000}");
  ExpectRemedy({.lift_servo = "kp='8000' kv='1e7'"},
               "the kv of its servo 'lifter', 1e+07, is too large for its stiffness of 8000 N/m",
               "{actuator: 'lifter', kv: 800}");
  ExpectRemedy(
      {.turn_servo = "kp='100' kv='250'"},
      "its servo's stiffness is 100 N m/rad against a damping of 250, so that it takes 2.5 s "
      "(1300 would do). Raise the stiffness of its servo (edits",
      "{actuator: 'turner', kp: 1300}");
  ExpectRemedy({.turn_servo = "kp='100'"}, "nothing damps it. Give its servo damping (edits",
               "{actuator: 'turner', kv: 2}");
}

TEST_F(UnlikeJoints, ReportsFrictionThatMakesAJointCreep) {
  ExpectRemedy({.lift = "frictionloss='300'", .lift_servo = "kp='8000' kv='1000'"},
               "its frictionloss of 300 is more than its servo 'lifter' pushes with when it is "
               "0.0002 m away (arrival_tolerance), 1.6 N at 8000 N/m",
               "{joint: 'lift', frictionloss: 0.8}");
  const std::vector<std::string> both = Doubts({.lift = "frictionloss='300'",
                                                .lift_servo = "kp='8000' kv='1000'",
                                                .turn = "frictionloss='300'",
                                                .turn_servo = "kp='100' kv='120'"});
  EXPECT_THAT(both, ElementsAre(AllOf(HasSubstr("; likewise '"),
                                      HasSubstr("{joint: 'lift', frictionloss: 0.8}"),
                                      HasSubstr("{joint: 'turn', frictionloss: "))))
      << "one text for all";
  EXPECT_THAT(Doubts({.lift = "frictionloss='1'", .turn = "frictionloss='0.1'"}), IsEmpty());
}

TEST_F(ArmTrials, TestsHoldingOnlyForTorqueArms) {
  EXPECT_THAT(Doubts("kp='2000' kv='100'", "control: {arm: joint_torque}\n"), IsEmpty());
}

}  // namespace
}  // namespace robocell
