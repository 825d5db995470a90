// Which arm carries the gripper that an environment mounts on a robot.
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/acting_arms.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/env_config.h"

namespace robocell::internal {

// Returns true if the gripper that the configuration mounts on a robot is on the robot's present first
// arm (acting_arms.h): it is on the first arm of the file.
inline bool CarriesMountedGripper(const EnvConfig& config, const Robot& robot) {
  if (!config.has_mounted_gripper(robot.name())) return false;
  const std::vector<std::string> arms = ArmNames(config.robots.at(robot.name()));
  return arms.size() < 2 || arms.front() == robot.arm().name();
}

}  // namespace robocell::internal
