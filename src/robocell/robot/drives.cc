#include "robocell/robot/drives.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/control_modes.h"
#include "robocell/scene/hold_ctrl.h"

namespace robocell::internal {
namespace {

std::vector<std::string> AddedActuators(const std::vector<std::string>& joints, CtrlMode mode) {
  std::vector<std::string> names;
  for (const std::string& joint : joints) names.push_back(ModeActuatorName(joint, mode));
  return names;
}

std::vector<int> Ids(const mjModel* m, const std::vector<std::string>& actuators) {
  std::vector<int> ids;
  for (const std::string& name : actuators) ids.push_back(FindId(m, mjOBJ_ACTUATOR, name));
  return ids;
}

bool Contains(const std::vector<int>& ids, int id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

// Returns the actuators that act on these joints, or on those that follow them.
std::vector<int> ActingOn(const Scene& scene, const std::vector<std::string>& joints) {
  const mjModel* m = scene.model();
  std::vector<bool> dofs(static_cast<size_t>(m->nv));
  std::vector<int> ids;
  for (const std::string& name : joints) {
    const int joint = FindId(m, mjOBJ_JOINT, name);
    if (joint < 0) continue;
    dofs[static_cast<size_t>(m->jnt_dofadr[joint])] = true;
    ids.push_back(joint);
  }
  for (const JointFollower& f : FollowersOf(m, ids))
    dofs[static_cast<size_t>(m->jnt_dofadr[f.joint])] = true;
  std::vector<int> acting;
  for (int a = 0; a < m->nactuator; ++a) {
    if (ActsOn(m, scene.data(), a, dofs)) acting.push_back(a);
  }
  return acting;
}

bool AllGroupsAreTaken(const mjModel* m) {
  std::set<int> taken(m->actuator_group, m->actuator_group + m->nactuator);
  taken.erase(0);
  return taken.size() >= static_cast<size_t>(kLastActuatorGroup);
}

// Returns the reason why the engine cannot switch these actuators in groups of their own, "" if it
// can. There are several groups if the last joint is separate from the others
// (Limb::may_end_in_finger). `beside`: actuators that are switched with them on purpose
// (SwitchBesides).
std::string WhyNotSwitchable(const mjModel* m, const std::vector<int>& ids,
                             const std::vector<int>& beside = {}) {
  if (ids.empty()) return "it has no actuators";
  std::set<int> groups;
  for (const int id : ids) groups.insert(m->actuator_group[id]);
  for (int a = 0; a < m->nactuator; ++a) {
    if (!groups.contains(m->actuator_group[a]) || Contains(ids, a) || Contains(beside, a)) continue;
    if (groups.contains(0) && AllGroupsAreTaken(m)) {
      return fmt::format(
          "the arms before it took all {} actuator groups that the engine can switch; set "
          "control_modes of robots that need no torque to [position]",
          kLastActuatorGroup);
    }
    return fmt::format(
        "its actuators are switched together with others ('{}'); give the robot a "
        "configuration with this arm as a move group",
        ElementName(m, mjOBJ_ACTUATOR, a));
  }
  const bool has_numbers = *groups.begin() >= 0 && *groups.rbegin() <= kLastActuatorGroup;
  return has_numbers ? "" : "no actuator group is left for its modes";
}

// Returns the groups of its actuators that can be switched; 0 for a user's own group that names
// none.
int GroupBits(const mjModel* m, const MoveGroup& drive) {
  int bits = 0;
  for (const std::string& name : drive.actuator_names()) {
    const int id = FindId(m, mjOBJ_ACTUATOR, name);
    const int group = id < 0 ? -1 : m->actuator_group[id];
    if (group >= 0 && group <= kLastActuatorGroup) bits |= 1 << group;
  }
  return bits;
}

// The possible origins of an arm's additional actuators.
enum class Origin { kConfigured, kBare, kObject };

Origin OriginOf(const Scene& scene, const std::vector<std::string>& joints) {
  const mjModel* m = scene.model();
  const int joint = joints.empty() ? -1 : FindId(m, mjOBJ_JOINT, joints.front());
  if (joint < 0) return Origin::kObject;
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    if (IsInSubtree(m, m->jnt_bodyid[joint], FindId(m, mjOBJ_BODY, robot.base_body)))
      return robot.config.move_groups.empty() ? Origin::kBare : Origin::kConfigured;
  }
  return Origin::kObject;
}

// Returns "'m1' is a motor" for the first actuator of another kind.
std::string WhatItHas(const mjModel* m, const std::vector<std::string>& actuators,
                      CtrlMode wanted) {
  for (const std::string& name : actuators) {
    const int id = FindId(m, mjOBJ_ACTUATOR, name);
    if (ActsOnJoint(m, id) && ActuatorKind(m, id) == wanted) continue;
    return fmt::format("'{}' is {}", name,
                       ActsOnJoint(m, id) ? DescribeActuator(m, id) : "on none of its joints");
  }
  return "";
}

// Returns advice for an arm whose actuators are of kind `native`, without any of `mode`.
std::string HowToGet(const std::string& group, CtrlMode mode, CtrlMode native, Origin origin) {
  const char* word = ActuatorWord(mode);
  const bool torque = native == CtrlMode::kTorque;
  if (mode == CtrlMode::kPosition && origin == Origin::kConfigured) {
    return fmt::format(
        "write `control: {{{}: joint_impedance}}` at the top level of the robot file, or {} there "
        "to "
        "command {}, or give the model {}s",
        group, torque ? "joint_torque" : "joint_velocity", torque ? "torques" : "velocities", word);
  }
  if (mode == CtrlMode::kPosition) {
    return fmt::format("drive it in ctrl_mode {0} by jnt_{1}_cmd, or give the model {2}s",
                       ToString(native), torque ? "trq" : "vel", word);
  }
  if (origin == Origin::kObject) {
    return fmt::format(
        "others are added only to robots, and this is not one. Add its model as one (RobotSpec) "
        "with {} in its control_modes, or give it {}s",
        ToString(mode), word);
  }
  return fmt::format("add {} to the control_modes of its RobotSpec", ToString(mode));
}

// Returns why an arm with actuators cannot be driven by those of `mode`, and what to do.
std::string WhyNotAdded(const mjModel* m, const std::string& group,
                        const std::vector<std::string>& own, bool pulls_tendons,
                        std::optional<CtrlMode> native, CtrlMode mode, Origin origin) {
  if (native && pulls_tendons) {
    return fmt::format(
        "some of its actuators pull tendons, and others are added only where one "
        "acts on each joint. Give the model {}s",
        ActuatorWord(mode));
  }
  if (!native) {
    return fmt::format("{}, and others are added to actuators of one kind only. Give the model {}s",
                       WhatItHas(m, own, mode), ActuatorWord(mode));
  }
  const std::string has =
      mode == CtrlMode::kPosition
          ? fmt::format("{}, no {}", WhatItHas(m, own, mode), ActuatorWord(mode))
          : std::string("the scene has no actuators for it");
  return has + ": " + HowToGet(group, mode, *native, origin);
}

// The slot with the drives keeps the group itself. Garbage collectors count its owners.
std::shared_ptr<MoveGroup> Unowned(const std::shared_ptr<MoveGroup>& group) {
  return {std::shared_ptr<void>(), group.get()};
}

}  // namespace

Drives OwnDrive(const std::shared_ptr<MoveGroup>& group) {
  Drives drives;
  drives.groups[static_cast<size_t>(CtrlMode::kPosition)] = Unowned(group);
  for (const CtrlMode mode : {CtrlMode::kVelocity, CtrlMode::kTorque})
    drives.why_none[static_cast<size_t>(mode)] = "only configured arms can be switched";
  return drives;
}

Drives FindDrives(const Scene& scene, const std::shared_ptr<ArmGroup>& arm, GroupNames names,
                  const std::string& why_no_actuators) {
  const mjModel* m = scene.model();
  const std::vector<std::string>& own = arm->actuator_names();
  Drives drives{.native = NativeMode(m, own)};
  if (own.empty()) {
    drives.why_none.fill(why_no_actuators);
    return drives;
  }
  const Origin origin = OriginOf(scene, names.joints);
  const bool pulls_tendons = std::any_of(own.begin(), own.end(), [&](const std::string& name) {
    return !ActsOnJoint(m, FindId(m, mjOBJ_ACTUATOR, name));
  });
  for (int i = 0; i < kCtrlModes; ++i) {
    const auto mode = static_cast<CtrlMode>(i);
    if (mode == drives.native) {
      drives.groups[i] = Unowned(arm);
      continue;
    }
    const std::vector<std::string> added = AddedActuators(names.joints, mode);
    const std::vector<int> ids = Ids(m, added);
    if (!drives.native || ids.empty() || Contains(ids, -1)) {
      drives.why_none[i] =
          WhyNotAdded(m, arm->name(), own, pulls_tendons, drives.native, mode, origin);
      continue;
    }
    // Followers that the model lists as joints of the arm have motors of their own, which rest.
    drives.why_none[i] = WhyNotSwitchable(
        m, ids, arm->has_followers() ? ActingOn(scene, names.joints) : std::vector<int>());
    if (drives.why_none[i].empty())
      drives.why_none[i] = WhyNotSwitchable(m, Ids(m, own), ActingOn(scene, names.joints));
    if (!drives.why_none[i].empty()) continue;
    names.actuators = added;
    drives.groups[i] = std::make_shared<ArmGroup>(scene, names);
  }
  return drives;
}

bool SwitchTo(CtrlMode mode, const Drives& drives, const Scene& scene) {
  const mjModel* m = scene.model();
  int others = 0;
  for (int i = 0; i < kCtrlModes; ++i) {
    if (drives.groups[i] && i != static_cast<int>(mode)) others |= GroupBits(m, *drives.groups[i]);
  }
  if (others == 0) return false;  // a single mode, whose actuators are as authored
  const int wanted = (m->opt.disableactuator | others) & ~GroupBits(m, *drives.of(mode));
  if (wanted == m->opt.disableactuator) return false;
  Scene(scene).mutable_model()->opt.disableactuator = wanted;
  return true;
}

ModeSwitches::ModeSwitches(const Scene& scene)
    : generation_(scene.generation()), off_(scene.model()->opt.disableactuator) {}

void ModeSwitches::PutBack(const Scene& scene) const {
  if (scene.closed() || scene.generation() != generation_) return;
  if (scene.model()->opt.disableactuator == off_) return;
  Scene(scene).mutable_model()->opt.disableactuator = off_;
}

std::optional<CtrlMode> ModeNow(const Drives& drives, const Scene& scene) {
  const mjModel* m = scene.model();
  std::optional<CtrlMode> mode;
  int sets = 0, on = 0;
  for (int i = 0; i < kCtrlModes; ++i) {
    if (!drives.groups[i]) continue;
    ++sets;
    if (m->opt.disableactuator & GroupBits(m, *drives.groups[i])) continue;
    ++on;
    mode = static_cast<CtrlMode>(i);
  }
  return sets > 1 && on == 1 ? mode : std::nullopt;
}

std::string PortController(CtrlMode mode) { return std::string("joint_") + ToString(mode); }

}  // namespace robocell::internal
