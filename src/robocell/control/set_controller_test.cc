// Tests which controllers can be installed in a group at run time, and the errors for the others.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "robocell/control/cartesian_impedance_controller.h"
#include "robocell/control/relative_joint_controller.h"
#include "robocell/robot/joint_position_controller.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/spec/group_controls.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(SetController, RejectsControllersThatAGripperCannotHave) {
  Robot robot = RobotAlone(Rc7());
  for (const std::string& kind : ControllerKinds()) {
    if (internal::WhyNotControlledBy(MoveGroupKind::kGripper, kind).empty()) continue;
    ExpectThrow<ArgumentError>(
        [&] { robot.SetController("gripper", kind); },
        fmt::format("group 'gripper': a gripper cannot have the controller '{}'. It can have: "
                    "joint_position, which takes its opening",
                    kind));
    EXPECT_EQ(robot.controller("gripper").kind(), "joint_position");
  }
  EXPECT_THROW(robot.SetController<RelativeJointController>("gripper"), ArgumentError);
  robot.SetController("gripper", "joint_position");
  EXPECT_EQ(robot.controller("gripper").target_kind(), TargetKind::kOpening);
}

TEST(SetController, RejectsControllersThatAGenericGroupCannotHave) {
  RobotConfig config = Rc7();
  MoveGroupConfig& arm = config.move_groups.at("arm");
  arm.kind = MoveGroupKind::kGeneric;
  Robot robot = RobotAlone(config);
  for (const char* kind : {"joint_torque", "joint_velocity", "cartesian_pose", "differential_ik"}) {
    ExpectThrow<ArgumentError>(
        [&] { robot.SetController("arm", kind); },
        fmt::format("group 'arm': a generic group cannot have the controller '{}'. It can have: "
                    "joint_position, relative_joint_position",
                    kind));
  }
  robot.SetController("arm", "relative_joint_position");
  EXPECT_EQ(robot.controller("arm").target_kind(), TargetKind::kJointSteps);
}

TEST(SetController, ByItsClassReturnsTheController) {
  Robot robot = RobotAlone(Rc7());
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  EXPECT_EQ(&soft, &robot.controller("arm"));
  EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kTorque);
}

// The gripper's controller has the same name and another class.
TEST(SetController, ByAMissingClassChangesNothing) {
  Robot robot = RobotAlone(Rc7());
  const Controller* before = &robot.controller("gripper");
  ExpectThrow<ArgumentError>(
      [&] { robot.SetController<JointPositionController>("gripper"); },
      "group 'gripper': controller 'joint_position' is of another class here than was asked for; "
      "put it in by its name");
  EXPECT_EQ(&robot.controller("gripper"), before);
}

}  // namespace
}  // namespace robocell
