// Tests arms that do not hold home or do not follow, reported with the reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST_F(ArmTrials, AStrongServoIsNotSpokenOf) {
  EXPECT_THAT(Doubts("kp='2000' kv='100'"), IsEmpty());
  EXPECT_THAT(Doubts("kp='50' kv='5'", "gravcomp: true\n"), IsEmpty());
}

TEST_F(ArmTrials, AServoThatSagsUnderGravityIsToldHowMuchItNeeds) {
  EXPECT_THAT(Doubts("kp='50' kv='5'"),
              ElementsAre(AllOf(
                  StartsWith(file_ + ":4:8: move_groups.arm: joint 'hip' drifts by 0.04"),
                  HasSubstr(" rad in 1 s while it should hold home (up to 0.01 rad is "
                            "tolerated): its servo's stiffness is 50 N m/rad, and gravity pulls "
                            "with 2.45 N m at home (490 would do). Set `gravcomp: true` or "
                            "raise the servos' stiffness (`stiffness`, N m/rad)"))));
}

// The advice leaves out settings that are already present.
TEST_F(ArmTrials, WhatIsSetIsLookedAt) {
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

TEST_F(ArmTrials, AJointThatNothingDampsIsToldThatItSwings) {
  EXPECT_THAT(Doubts("kp='500'", "gravcomp: true\n"),
              ElementsAre(AllOf(HasSubstr("joint 'hip' still swings by 0."),
                                HasSubstr(" rad around its target when it is sent there from home "
                                          "and given 2.5 s: nothing damps it. Give its servo "
                                          "damping (`damping`, N m s/rad)"))));
  EXPECT_THAT(Doubts("kp='500'", "gravcomp: true\ndamping: 1e-3\n"),
              ElementsAre(HasSubstr("Raise `damping` (0.001 is set)")));
}

// Whatever the servo may push, and says: it is not too weak.
TEST_F(ArmTrials, AJointWithATypingErrorIsToldByItsEdit) {
  EXPECT_THAT(Doubts("kp='500' kv='50' forcerange='-2 2'",
                     "gravcomp: true\nedits: [{joint: hip, damping: 1.0e+12}]\n"),
              ElementsAre(AllOf(HasSubstr(": its damping of 1e+12 is too large for its servo's "
                                          "stiffness of 500 N m/rad"),
                                HasSubstr("edit: [{joint: 'hip', damping: 50}]"))));
  EXPECT_THAT(Doubts("kp='500' kv='50' forcerange='-2 2'",
                     "gravcomp: true\nedits: [{joint: hip, armature: 1.0e+9}]\n"),
              ElementsAre(HasSubstr("its armature of 1e+09 is too large for its servo's")));
}

TEST_F(ArmTrials, AKvThatIsATypingErrorIsToldAtItsServo) {
  EXPECT_THAT(Doubts("kp='500' kv='1e7' forcerange='-50 50'", "gravcomp: true\n"),
              ElementsAre(AllOf(HasSubstr(": the kv of its servo 'drive', 1e+07, is too large for "
                                          "its stiffness of 500 N m/rad"),
                                HasSubstr("Lower it in the model to 50"))));
}

TEST_F(ArmTrials, FrictionAboveTheForceOfAServoIsTold) {
  EXPECT_THAT(
      Doubts("kp='2000' kv='100' forcerange='-60 60'", "gravcomp: true\n", "",
             "frictionloss='100'"),
      ElementsAre(HasSubstr("only creeps when it is sent there from home and given 2.5 s: "
                            "its frictionloss of 100 is more than the 60 N m that its servo "
                            "'drive' may push with")));
}

TEST_F(ArmTrials, AServoThatIsTooWeakIsToldWithItsLimit) {
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

TEST_F(ArmTrials, AServoThatMayNotBeSentThereIsToldWithItsRange) {
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
TEST_F(ArmTrials, AServoThatTheSceneWarnsOfIsToldOnce) {
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
TEST_F(ArmTrials, AServoThatSomethingElseHoldsIsToldWithWhatIsMeasured) {
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

TEST_F(ArmTrials, AnArmOfTorquesIsHeldOnly) {
  EXPECT_THAT(Doubts("kp='2000' kv='100'", "control: {arm: joint_torque}\n"), IsEmpty());
}

}  // namespace
}  // namespace robocell
