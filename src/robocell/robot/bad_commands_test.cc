// Tests that every path into the engine rejects NaN and wrong counts, names robot and group, and
// changes nothing. Robot::Apply has its own tests.
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/robot/testing/commanded_robot.h"

namespace robocell {
namespace {

class BadCommands : public CommandedRobot {};

TEST_F(BadCommands, ErrorsOfControllersNameRobotAndGroup) {
  for (const char* kind : {"joint_position", "relative_joint_position"}) {
    robot.SetController("arm", kind);
    Controller& arm = robot.controller("arm");
    Refuses([&] { arm.SetTarget(std::vector<double>(6)); },
            kArm + ": expected 7 joint values, got 6");
    Refuses([&] { arm.SetTarget(WithNan(home, 3)); },
            kArm + ": the target of 'joint4' is nan; targets must be finite");
  }
  Controller& gripper = robot.controller("gripper");
  Refuses([&] { gripper.SetTarget(std::vector<double>(2)); },
          kGripper + ": expected 1 opening value, got 2");
  Refuses([&] { gripper.SetTarget(std::vector{kNan}); },
          kGripper + ": the target of 'opening' is nan");
}

TEST_F(BadCommands, ErrorsOfGroupsNameTheElement) {
  MoveGroup& arm = robot.arm();
  Refuses([&] { arm.SetCtrl(std::vector<double>(8)); },
          kArm + ": expected 7 control values, got 8");
  Refuses([&] { arm.SetCtrl(WithNan(home, 0)); },
          kArm + ": actuator 'servo1' cannot be set to nan");
  Refuses([&] { arm.SetJointPos(WithNan(home, 6)); },
          kArm + ": joint 'joint7' cannot be set to nan");
  Refuses([&] { arm.SetJointVel(std::vector<double>{}); },
          kArm + ": expected 7 joint velocity values, got 0");
  Refuses([&] { robot.gripper().SetOpening(kNan); }, kGripper + ": opening cannot be nan");
}

TEST_F(BadCommands, RejectsAnOverflowedPose) {
  const Pose far(Eigen::Vector3d(1.7e308, 0, 0));
  Refuses(
      [&] {
        robot.Apply({{"arm", GroupCommand::LeafPose(far * far)}});
      },
      kArm + ": the target pose has a number that is not finite");
}

TEST_F(BadCommands, ErrorsOfScenesNameActuatorAndBody) {
  Scene scene = robot.scene();
  Refuses([&] { scene.SetActuatorCtrl("servo3", kNan); },
          "scene 'test': control of actuator 'servo3' must be a finite number, got nan");
  Refuses(
      [&] {
        scene.SetBodyWrench("link3", {0, kNan, 0}, {0, 0, 0});
      },
      "scene 'test': force on body 'link3' must be a finite number, got nan");
  Refuses([&] { scene.SetState(std::vector<double>(3)); }, "scene 'test': a state has ");
}

}  // namespace
}  // namespace robocell
