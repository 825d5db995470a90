// For tests only: an environment of two arms with hands.
#pragma once

#include "robocell/spec/env_config.h"
#include "robocell/spec/testing/messages.h"

namespace robocell {

inline RobotConfig Arm() {
  RobotConfig arm{.name = "arm", .model = "arm.xml", .attachment_site = "flange"};
  arm.move_groups["arm"] = {.kind = MoveGroupKind::kArm, .joints = {"j1", "j2"}};
  return arm;
}

inline RobotConfig Hand() {
  RobotConfig hand{.name = "hand", .model = "hand.xml"};
  hand.move_groups["gripper"] = {.kind = MoveGroupKind::kGripper, .actuators = {"grip"}};
  return hand;
}

// Two arms side by side, each with a gripper.
inline EnvConfig Duo() {
  EnvConfig env;
  for (const char* side : {"left", "right"}) {
    env.robots[side] = Arm();
    env.grippers[side] = Hand();
  }
  env.robot_to_shared_base_frame["left"] = Pose(Eigen::Vector3d(0, 0.3, 0));
  env.robot_to_shared_base_frame["right"] = Pose(Eigen::Vector3d(0, -0.3, 0));
  return env;
}

inline EnvObject Thing() { return {.mjcf_path = "thing.xml"}; }

inline std::string Message(const EnvConfig& env) { return testing::ValidationError(env); }

}  // namespace robocell
