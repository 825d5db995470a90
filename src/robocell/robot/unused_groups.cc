#include "robocell/robot/unused_groups.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <vector>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/control_modes.h"

namespace robocell::internal {
namespace {

std::set<std::string> CommandedActuators(const Robot& robot) {
  std::set<std::string> names;
  for (const std::string& name : robot.group_names()) {
    const MoveGroup& group = robot.group(name);
    names.insert(group.actuator_names().begin(), group.actuator_names().end());
    for (const std::string& joint : group.joint_names()) {
      for (const auto& [mode, word] : EnumNames<CtrlMode>::kNames)
        names.insert(ModeActuatorName(joint, mode));
    }
  }
  return names;
}

}  // namespace

std::string DescribeUnusedGroups(const Robot& robot) {
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

namespace {

// Returns true for the velocity servo of a PD pair: it brakes a joint whose position servo is
// commanded, and its own control is the 0 that it is meant to have.
bool BrakesACommandedJoint(const mjModel* m, int actuator, const std::set<std::string>& commanded) {
  if (!ActsOnJoint(m, actuator) || ActuatorKind(m, actuator) != CtrlMode::kVelocity) return false;
  const int joint = m->actuator_trnid[2 * actuator];
  for (int a = 0; a < m->nactuator; ++a) {
    if (ActsOnJoint(m, a) && m->actuator_trnid[2 * a] == joint && IsPositionServo(m, a) &&
        commanded.contains(ElementName(m, mjOBJ_ACTUATOR, a)))
      return true;
  }
  return false;
}

}  // namespace

std::vector<std::string> IdleActuators(const Robot& robot) {
  const mjModel* m = robot.scene().model();
  const std::vector<int>& parts = robot.body_ids();
  const std::set<std::string> commanded = CommandedActuators(robot);
  std::vector<std::string> idle;
  for (int a = 0; a < m->nactuator; ++a) {
    const std::string name = ElementName(m, mjOBJ_ACTUATOR, a);
    const bool own = std::find(parts.begin(), parts.end(), BodyOfActuator(m, a)) != parts.end();
    if (!own || commanded.contains(name) || BrakesACommandedJoint(m, a, commanded)) continue;
    idle.push_back(name.starts_with(robot.prefix()) ? name.substr(robot.prefix().size()) : name);
  }
  return idle;
}

}  // namespace robocell::internal
