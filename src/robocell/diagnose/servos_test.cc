// Servos whose ctrlrange does not fit their joints.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/scene/testing/arm_with_hand.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using ServoRanges = ArmWithHand;

TEST_F(ServoRanges, AServoThatHardlyMovesOrIsNotAtHome) {
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

TEST_F(ServoRanges, AServoThatStopsBeforeItsJointIsANote) {
  Model({.hip_ctrl = "-0.5 2", .knee_ctrl = "-2.25 2.25"});
  const Scene scene = Build();
  EXPECT_THAT(scene.compiled()->warnings(), IsEmpty());
  EXPECT_THAT(scene.compiled()->notes(),
              ElementsAre("robot 'arm': servos of 'arm' stop before their joints do (their "
                          "ctrlrange): s1 -0.5 to 2 of -2 to 2, s2 -2.25 to 2.25 of -2.5 to 2.5"));
}

TEST_F(ServoRanges, ControlsInDegrees) {
  EXPECT_THAT(Warnings({.knee_ctrl = "-143 143"}),
              ElementsAre(model_ + ":12: robot 'arm': the servo 's2' takes -143 to 143 rad for "
                                   "joint 'knee' (its ctrlrange), which may move from -2.5 to 2.5 "
                                   "rad. Are these degrees? The engine converts joints' ranges, "
                                   "never ctrlrange: edits: [{actuator: 's2', ctrlrange: [-2.5, "
                                   "2.5]}]"));
  EXPECT_THAT(Warnings({.knee_ctrl = "-7 7"}), IsEmpty());
}

TEST_F(ServoRanges, OnlyTheServosThatTheArmIsDrivenBy) {
  const std::string fine =
      "<actuator><position name=\"s0\" joint=\"hip\" ctrlrange=\"0.1 0.2\"/></actuator>";
  Model({.first = fine});
  EXPECT_THAT(Build("", ", actuators: [s1, s2]").compiled()->warnings(), IsEmpty());
  EXPECT_THAT(Build().compiled()->warnings(), ElementsAre(HasSubstr("the servo 's0' sends")));
  EXPECT_THAT(Warnings({.hip_ctrl = "1 2"}, "control: {arm: joint_torque}\n"), IsEmpty());
}

}  // namespace
}  // namespace robocell
