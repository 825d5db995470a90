#include "robocell/robot/drives.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>

#include "robocell/mujoco/names.h"
#include "robocell/scene/control_modes.h"

namespace robocell {
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

bool AllGroupsAreTaken(const mjModel* m) {
  std::set<int> taken(m->actuator_group, m->actuator_group + m->nactuator);
  taken.erase(0);
  return taken.size() >= static_cast<size_t>(kLastActuatorGroup);
}

// Whether one of the engine's groups holds these actuators and no others; why not, else "".
std::string WhyNotSwitchable(const mjModel* m, const std::vector<int>& ids) {
  const int group = m->actuator_group[ids[0]];
  for (int a = 0; a < m->nactuator; ++a) {
    if ((m->actuator_group[a] == group) == Contains(ids, a)) continue;
    if (group == 0 && AllGroupsAreTaken(m)) {
      return fmt::format(
          "the arms before it took all {} actuator groups that the engine can switch; set "
          "control_modes of robots that need no torque to [position]",
          kLastActuatorGroup);
    }
    return fmt::format(
        "its actuators are switched together with others ('{}'); give the robot a "
        "configuration with this arm as a move group",
        ElementName(m, mjOBJ_ACTUATOR, Contains(ids, a) ? ids[0] : a));
  }
  return group >= 0 && group <= kLastActuatorGroup ? "" : "no actuator group is left for its modes";
}

int GroupBit(const mjModel* m, const MoveGroup& drive) {
  const int id = FindId(m, mjOBJ_ACTUATOR, drive.actuator_names()[0]);
  return id < 0 ? 0 : 1 << m->actuator_group[id];
}

// The slot that has the drives keeps the group itself. Collectors count who keeps a group.
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

Drives FindDrives(const Scene& scene, const std::shared_ptr<ArmGroup>& arm, GroupNames names) {
  const mjModel* m = scene.model();
  const std::vector<std::string>& own = arm->actuator_names();
  // Others are refused where they are asked for a position, which says what they are.
  const CtrlMode native = NativeMode(m, own).value_or(CtrlMode::kPosition);
  Drives drives;
  for (int i = 0; i < kCtrlModes; ++i) {
    const auto mode = static_cast<CtrlMode>(i);
    if (mode == native) {
      drives.groups[i] = Unowned(arm);
      continue;
    }
    const std::vector<std::string> added = AddedActuators(names.joints, mode);
    const std::vector<int> ids = Ids(m, added);
    if (ids.empty() || Contains(ids, -1)) {
      drives.why_none[i] =
          mode == CtrlMode::kPosition
              ? "it has no position servos"
              : fmt::format(
                    "the scene has no actuators for it: add {} to the control_modes of "
                    "its RobotSpec",
                    ToString(mode));
      continue;
    }
    drives.why_none[i] = WhyNotSwitchable(m, ids);
    if (drives.why_none[i].empty()) drives.why_none[i] = WhyNotSwitchable(m, Ids(m, own));
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
    if (drives.groups[i] && i != static_cast<int>(mode)) others |= GroupBit(m, *drives.groups[i]);
  }
  if (others == 0) return false;  // one mode only, whose actuators are as authored
  const int wanted = (m->opt.disableactuator | others) & ~GroupBit(m, *drives.of(mode));
  if (wanted == m->opt.disableactuator) return false;
  Scene(scene).mutable_model()->opt.disableactuator = wanted;
  return true;
}

std::optional<CtrlMode> ModeNow(const Drives& drives, const Scene& scene) {
  const mjModel* m = scene.model();
  std::optional<CtrlMode> mode;
  int sets = 0, on = 0;
  for (int i = 0; i < kCtrlModes; ++i) {
    if (!drives.groups[i]) continue;
    ++sets;
    if (m->opt.disableactuator & GroupBit(m, *drives.groups[i])) continue;
    ++on;
    mode = static_cast<CtrlMode>(i);
  }
  return sets > 1 && on == 1 ? mode : std::nullopt;
}

std::string PortController(CtrlMode mode) { return std::string("joint_") + ToString(mode); }

}  // namespace robocell
