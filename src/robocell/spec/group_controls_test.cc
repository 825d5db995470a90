#include "robocell/spec/group_controls.h"

#include <gtest/gtest.h>

#include "robocell/spec/env_config.h"
#include "robocell/spec/robot_spec.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using testing::ValidationError;

constexpr MoveGroupKind kKinds[] = {MoveGroupKind::kArm, MoveGroupKind::kGripper,
                                    MoveGroupKind::kBase, MoveGroupKind::kGeneric};

// A robot with one group of each kind, named like its kind.
RobotConfig OneOfEach() {
  return {.name = "robot",
          .model = "robot.xml",
          .move_groups = {{"arm", {.kind = MoveGroupKind::kArm, .joints = {"a", "b"}}},
                          {"gripper", {.kind = MoveGroupKind::kGripper, .actuators = {"grip"}}},
                          {"base", {.kind = MoveGroupKind::kBase}},
                          {"generic", {.kind = MoveGroupKind::kGeneric, .joints = {"torso"}}}}};
}

TEST(GroupControls, ARobotFileIsValidExactlyWhenItsGroupsCanHaveTheirControllers) {
  for (const MoveGroupKind group : kKinds) {
    const std::vector<ControlKind> allowed = ControlsOf(group);
    for (const auto& [control, name] : EnumNames<ControlKind>::kNames) {
      RobotConfig robot = OneOfEach();
      robot.control[ToString(group)] = control;
      const bool valid = std::find(allowed.begin(), allowed.end(), control) != allowed.end();
      EXPECT_EQ(ValidationError(robot).empty(), valid) << ToString(group) << ": " << name;
      EXPECT_EQ(WhyNotControlledBy(group, name).empty(), valid) << ToString(group) << ": " << name;
    }
  }
}

TEST(GroupControls, ErrorsNameGroupControllerAndAlternatives) {
  RobotConfig robot = OneOfEach();
  robot.control["gripper"] = ControlKind::kRelativeJointPosition;
  EXPECT_EQ(ValidationError(robot),
            "it is not valid: control.gripper: a gripper cannot have the controller "
            "'relative_joint_position'. It can have: joint_position, which takes its opening");
  robot = OneOfEach();
  robot.control["generic"] = ControlKind::kJointTorque;
  EXPECT_EQ(ValidationError(robot),
            "it is not valid: control.generic: a generic group cannot have the controller "
            "'joint_torque'. It can have: joint_position, relative_joint_position");
}

TEST(GroupControls, ReportSeveralProblemsTogether) {
  RobotConfig robot = OneOfEach();
  robot.control["gripper"] = ControlKind::kRelativeJointPosition;
  robot.control["base"] = ControlKind::kCartesianPose;
  robot.control["generic"] = ControlKind::kJointImpedance;
  EXPECT_NE(ValidationError(robot).find("3 problems"), std::string::npos) << ValidationError(robot);
}

TEST(GroupControls, AcceptCustomControllers) {
  for (const MoveGroupKind group : kKinds) EXPECT_EQ(WhyNotControlledBy(group, "mine"), "");
  EXPECT_NE(WhyNotControlledBy(MoveGroupKind::kGripper, "differential_ik"), "");
}

// Scenes, environments and runs contain robot files, and all of them check these.
TEST(GroupControls, EveryFileWithARobotRejectsThem) {
  RobotConfig robot = OneOfEach();
  robot.control["gripper"] = ControlKind::kRelativeJointPosition;
  const std::string wrong = "control.gripper: a gripper cannot have the controller";
  SceneSpec scene;
  scene.robots.push_back({.name = "left", .config = robot});
  EXPECT_NE(ValidationError(scene).find(wrong), std::string::npos) << ValidationError(scene);
  EnvConfig env;
  env.robots["left"] = robot;
  EXPECT_NE(ValidationError(env).find(wrong), std::string::npos) << ValidationError(env);
  EnvConfig mounted;
  mounted.grippers["left"] = robot;
  EXPECT_NE(ValidationError(mounted).find(wrong), std::string::npos) << ValidationError(mounted);
  RunConfig run;
  run.robot.config = robot;
  EXPECT_NE(ValidationError(run).find(wrong), std::string::npos) << ValidationError(run);
}

}  // namespace
}  // namespace robocell::internal
