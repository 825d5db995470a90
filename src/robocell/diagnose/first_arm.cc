// The arm and gripper that are meant where one of each is used: the first arm of the robot's file,
// and the gripper that this arm carries.
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

// Warns of a robot whose gripper is on another arm than the first.
void WarnOfGripperElsewhere(const Robot& robot, const std::vector<std::string>& arms,
                            Findings& findings) {
  for (const std::string& arm : arms) {
    const std::string gripper = robot.gripper_of(arm);
    if (gripper.empty()) continue;
    if (arm == arms.front()) return;
    return findings.WarnAbout(
        "move_groups",
        fmt::format("the first arm, '{}', which environments and pick tasks use, carries no "
                    "gripper: '{}' is on '{}'. Put the arm with the gripper before other arms",
                    arms.front(), gripper, arm));
  }
}

void NoteWhichIsUsed(const char* kind, const std::vector<std::string>& groups, const char* which,
                     const std::string& used, Findings& findings) {
  if (groups.size() < 2 || used.empty()) return;
  findings.Note(
      fmt::format("move_groups has {} of kind {}: {}. Environments and pick tasks use {}, '{}', "
                  "and hold the others still; robot.group(name) has each of them",
                  groups.size(), kind, fmt::join(groups, ", "), which, used));
}

}  // namespace

void TryFirstArm(Robot& robot, const TrialOptions& options, Findings& findings) {
  if (options.for_run) return;
  const std::vector<std::string> arms = GroupsOfKind(robot, MoveGroupKind::kArm);
  if (arms.empty()) return;
  WarnOfGripperElsewhere(robot, arms, findings);
  NoteWhichIsUsed("arm", arms, "the first", arms.front(), findings);
  NoteWhichIsUsed("gripper", GroupsOfKind(robot, MoveGroupKind::kGripper), "that of the first arm",
                  robot.gripper_of(arms.front()), findings);
}

}  // namespace robocell::internal
