// Fingers that can hold nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/scene/testing/arm_with_hand.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

using FingerChecks = ArmWithHand;

TEST_F(FingerChecks, AGripperTooWeakToHoldAnything) {
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

TEST_F(FingerChecks, AFingerThatTouchesNothing) {
  EXPECT_THAT(Warnings({.finger = "contype=\"0\" conaffinity=\"0\""}),
              ElementsAre(AllOf(StartsWith(file_ + ":5:33: robot 'arm': move_groups.hand.joints: "),
                                HasSubstr("no geom of the finger 'left' collides (their contype "
                                          "and conaffinity are 0), so it can hold nothing"))));
}

}  // namespace
}  // namespace robocell
