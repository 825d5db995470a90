#include "robocell/robot/unused_groups.h"

#include <fmt/format.h>

#include <vector>

#include "robocell/base/suggestions.h"

namespace robocell {

std::string TellUnusedGroups(const Robot& robot) {
  std::string arm, gripper;
  std::vector<std::string> unused;
  for (const std::string& name : robot.group_names()) {
    const MoveGroupKind kind = robot.group(name).kind();
    if (kind == MoveGroupKind::kArm && arm.empty()) {
      arm = name;
      gripper = robot.gripper_of(name);
    } else if (kind == MoveGroupKind::kArm) {
      unused.push_back(name);
    }
  }
  if (arm.empty()) return "";
  bool has_other_gripper = false;
  for (const std::string& name : robot.group_names()) {
    if (robot.group(name).kind() != MoveGroupKind::kGripper || name == gripper) continue;
    has_other_gripper = true;
    unused.push_back(name);
  }
  if (unused.empty()) return "";
  const std::string used = !gripper.empty()    ? fmt::format(" and its gripper '{}' are", gripper)
                           : has_other_gripper ? ", which carries no gripper, is"
                                               : " is";
  return fmt::format("arm '{}'{} used; {} hold{} still", arm, used, ListNames(unused),
                     unused.size() == 1 ? "s" : "");
}

}  // namespace robocell
