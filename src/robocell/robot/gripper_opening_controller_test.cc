#include "robocell/robot/gripper_opening_controller.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"

namespace robocell::internal {
namespace {

class GripperOpeningControllerTest : public ::testing::Test {
 protected:
  double Target() { return robot_.controller("gripper").target()[0]; }

  Robot robot_ = RobotAlone(Rc7());
};

TEST_F(GripperOpeningControllerTest, ATargetMovesTheFingersToThatOpening) {
  for (const double opening : {0.0, 0.4, 1.0}) {
    robot_.controller("gripper").SetTarget(std::vector<double>{opening});
    for (int i = 0; i < 1000; ++i) {
      robot_.Update();
      ASSERT_TRUE(robot_.Step().ok());
    }
    EXPECT_EQ(Target(), opening);
    EXPECT_NEAR(robot_.gripper().opening(), opening, 0.02);
  }
}

// The inverse of the group's own control.
TEST_F(GripperOpeningControllerTest, AResetFindsTheOpeningOfTheControl) {
  for (const double opening : {0.0, 0.1, 0.37, 0.9, 1.0}) {
    robot_.gripper().SetOpening(opening);
    robot_.controller("gripper").Reset();
    EXPECT_NEAR(Target(), opening, 1e-9);
  }
}

TEST_F(GripperOpeningControllerTest, AdoptsAnOpeningThatIsCommandedAtTheGroup) {
  robot_.controller("gripper").SetTarget(std::vector<double>{1.0});
  robot_.Update();
  robot_.gripper().SetOpening(0.25);
  robot_.Update();
  EXPECT_NEAR(Target(), 0.25, 1e-9);
}

TEST_F(GripperOpeningControllerTest, ClipsOpeningsAndRejectsWhatIsNoNumber) {
  Controller& controller = robot_.controller("gripper");
  controller.SetTarget(std::vector<double>{1.5});
  EXPECT_EQ(Target(), 1);
  controller.SetTarget(std::vector<double>{-0.5});
  EXPECT_EQ(Target(), 0);
  EXPECT_THROW(controller.SetTarget(std::vector<double>{NAN}), ArgumentError);
  EXPECT_THROW(controller.SetTarget(std::vector<double>{0.1, 0.2}), ArgumentError);
  EXPECT_EQ(Target(), 0);
}

}  // namespace
}  // namespace robocell::internal
