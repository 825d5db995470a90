#include "robocell/robot/acting_arms.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace robocell::internal {

std::vector<std::string> ArmNames(const RobotConfig& config) {
  std::vector<std::string> names;
  for (const auto& [name, group] : config.move_groups.entries()) {
    if (group->kind == MoveGroupKind::kArm) names.push_back(name);
  }
  return names;
}

RobotConfig WithArmFirst(const RobotConfig& config, const std::string& arm) {
  RobotConfig out = config;
  out.move_groups = {};
  out.move_groups[arm] = config.move_groups.at(arm);
  for (const auto& [name, group] : config.move_groups.entries()) {
    if (name != arm) out.move_groups[name] = *group;
  }
  return out;
}

std::vector<std::string> ActingArms(const RobotConfig& config, const std::string& robot) {
  const std::vector<std::string> arms = ArmNames(config);
  if (arms.size() < 2) return {robot};
  std::vector<std::string> names;
  for (const std::string& arm : arms) names.push_back(fmt::format("{}/{}", robot, arm));
  return names;
}

std::vector<std::string> ActingArms(const Scene& scene) {
  std::vector<std::string> names;
  for (const Robot& robot : RobotsOf(scene)) {
    if (!robot.has_arm()) continue;
    for (std::string& name : ActingArms(robot.config(), robot.name()))
      names.push_back(std::move(name));
  }
  return names;
}

std::string ActingName(const Robot& robot) {
  if (!robot.has_arm() || ArmNames(robot.config()).size() < 2) return robot.name();
  return robot.name() + "/" + robot.arm().name();
}

}  // namespace robocell::internal
