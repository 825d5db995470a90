// Tests actuators that no command reaches.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/diagnose/testing/bar.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

using UndrivenGroups = BarTrial;

TEST_F(UndrivenGroups, ActuatorsOfNoGroupAreNamed) {
  const std::string more =
      "kp='2000' kv='100'/><motor name='spare' joint='hip'/><motor name='thruster' site='tip'";
  EXPECT_THAT(Doubts(more),
              ElementsAre(AllOf(StartsWith(file_ + ":4:"),
                                HasSubstr("move_groups: no move group has the actuators spare, "
                                          "thruster: nothing will command them"))));
  EXPECT_THAT(Doubts("kp='2000' kv='100'", "control: {arm: joint_torque}\ngravcomp: true\n"),
              Not(Contains(HasSubstr("no move group"))));
}

TEST_F(UndrivenGroups, VelocityServosBesidePositionServosAreMeantToBrake) {
  EXPECT_THAT(Doubts("kp='2000'/><velocity name='brake' kv='100' joint='hip'"), ElementsAre());
}

TEST_F(UndrivenGroups, ActuatorsOfSeveralInputsAreNamedOnce) {
  const std::string more =
      "kp='2000' kv='100'/><pid name='spare' joint='spin' kp='1' kv='1' input='pos vel ff'/>"
      "<pid name='other' joint='spin' kp='1' kv='1' input='pos vel ff'";
  EXPECT_THAT(
      Doubts(more, "",
             "<body name='fan' pos='0 0 -0.9'><joint name='spin'/><geom size='0.01'/></body>"),
      ElementsAre(HasSubstr("no move group has the actuators spare, other: nothing")));
}

}  // namespace
}  // namespace robocell
