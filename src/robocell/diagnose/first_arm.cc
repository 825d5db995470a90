// Which arms of a robot act, and with which gripper each.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "robocell/base/suggestions.h"
#include "robocell/diagnose/trials.h"

namespace robocell::internal {
namespace {

// Returns the groups of a kind, in the order of the file.
std::vector<std::string> GroupsOfKind(const Robot& robot, MoveGroupKind kind) {
  std::vector<std::string> names;
  for (const auto& [name, group] : robot.config().move_groups.entries()) {
    if (group->kind == kind) names.push_back(name);
  }
  return names;
}

// Notes which gripper goes with which of several arms.
void NoteArms(const Robot& robot, const std::vector<std::string>& arms, Findings& findings) {
  if (arms.size() < 2) return;
  std::vector<std::string> with_hands;
  for (const std::string& arm : arms) {
    const std::string gripper = robot.gripper_of(arm);
    with_hands.push_back(gripper.empty() ? fmt::format("{} without a gripper", arm)
                                         : fmt::format("{} with {}", arm, gripper));
  }
  findings.Note(fmt::format(
      "move_groups has {} of kind arm: {}. Environments act with all of them. In a run the nearest "
      "arm with a gripper that can do the task does it, or the one that `arm` of a pick names",
      arms.size(), fmt::join(with_hands, ", ")));
}

// Notes grippers of no arm, or of an arm that has another one.
void NoteOtherGrippers(const Robot& robot, const std::vector<std::string>& arms,
                       Findings& findings) {
  std::vector<std::string> others = GroupsOfKind(robot, MoveGroupKind::kGripper);
  for (const std::string& arm : arms) std::erase(others, robot.gripper_of(arm));
  if (others.empty()) return;
  findings.Note(
      fmt::format("move_groups has {} more of kind gripper than arms that carry them: {}. "
                  "Environments and runs "
                  "hold {} still; robot.group(name) has each of them",
                  others.size(), fmt::join(others, ", "), others.size() == 1 ? "it" : "them"));
}

}  // namespace

void TryFirstArm(Robot& robot, const TrialOptions& options, Findings& findings) {
  if (options.for_run) return;
  const std::vector<std::string> arms = GroupsOfKind(robot, MoveGroupKind::kArm);
  if (arms.empty()) return;
  NoteArms(robot, arms, findings);
  NoteOtherGrippers(robot, arms, findings);
}

}  // namespace robocell::internal
