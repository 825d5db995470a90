// Finds overlaps of a robot with anything before it has moved.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robocell/diagnose/trials.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/gripper_group.h"

namespace robocell::internal {
namespace {

// Returns true if a gripper moves both bodies: a closed one touches itself.
bool InOneGripper(const Robot& robot, int a, int b) {
  const mjModel* m = robot.scene().model();
  for (const std::string& name : robot.group_names()) {
    const auto* gripper = dynamic_cast<const ActuatedGripper*>(&robot.group(name));
    if (!gripper) continue;
    const int hand = gripper->hand_body();
    const auto moved = [&](int body) {
      return IsInSubtree(m, body, hand) && m->body_weldid[body] != m->body_weldid[hand];
    };
    if (moved(a) && moved(b)) return true;
  }
  return false;
}

// Returns true if a robot stands on one body with the other: a body that no arm or gripper moves.
bool StandsOn(const Robot& robot, int a, int b) {
  const mjModel* m = robot.scene().model();
  if (m->body_weldid[a] != 0 && m->body_weldid[b] != 0) return false;
  const int body = m->body_weldid[a] == 0 ? b : a;
  for (const std::string& name : robot.group_names()) {
    const MoveGroup& group = robot.group(name);
    if (group.kind() != MoveGroupKind::kArm && group.kind() != MoveGroupKind::kGripper) continue;
    for (const std::string& joint : group.joint_names()) {
      if (IsInSubtree(m, body, m->jnt_bodyid[FindId(m, mjOBJ_JOINT, joint)])) return false;
    }
  }
  return true;
}

}  // namespace

void TryHomeContacts(Robot& robot, const TrialOptions&, Findings& findings) {
  const mjModel* m = robot.scene().model();
  const auto own = [&](const std::string& name) {
    return name.starts_with(robot.prefix()) ? name.substr(robot.prefix().size()) : name;
  };
  const auto is_part = [&](int body) {
    const std::vector<int>& parts = robot.body_ids();
    return std::find(parts.begin(), parts.end(), body) != parts.end();
  };
  std::set<std::pair<std::string, std::string>> pairs;
  for (const Contact& contact : robot.scene().contacts()) {
    if (contact.distance > 0) continue;  // within a margin only
    const int a = FindId(m, mjOBJ_BODY, contact.body1), b = FindId(m, mjOBJ_BODY, contact.body2);
    if (!is_part(a) && !is_part(b)) continue;
    if (InOneGripper(robot, a, b) || StandsOn(robot, a, b)) continue;
    pairs.insert(std::minmax(own(contact.body1), own(contact.body2)));
  }
  for (const auto& [a, b] : pairs) {
    findings.WarnAbout("home",
                       fmt::format("'{}' and '{}' touch at home: exclude the pair in the model or "
                                   "choose another `home`",
                                   a, b));
  }
}

}  // namespace robocell::internal
