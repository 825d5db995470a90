#include "robocell/robot/idle_actuators.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>

#include "robocell/mujoco/names.h"
#include "robocell/scene/control_modes.h"

namespace robocell {
namespace {

int BodyOfWrap(const mjModel* m, int wrap) {
  const int id = m->wrap_objid[wrap];
  switch (m->wrap_type[wrap]) {
    case mjWRAP_JOINT:
      return m->jnt_bodyid[id];
    case mjWRAP_SITE:
      return m->site_bodyid[id];
    default:
      return -1;
  }
}

// One body that an actuator acts on; -1 when that is not known.
int BodyOfActuator(const mjModel* m, int actuator) {
  const int id = m->actuator_trnid[2 * actuator];
  switch (m->actuator_trntype[actuator]) {
    case mjTRN_JOINT:
    case mjTRN_JOINTINPARENT:
      return m->jnt_bodyid[id];
    case mjTRN_SITE:
    case mjTRN_SLIDERCRANK:
      return m->site_bodyid[id];
    case mjTRN_TENDON:
      return BodyOfWrap(m, m->tendon_adr[id]);
    case mjTRN_BODY:
      return id;
    default:
      return -1;
  }
}

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

std::vector<std::string> IdleActuators(const Robot& robot) {
  const mjModel* m = robot.scene().model();
  const std::vector<int>& parts = robot.body_ids();
  const std::set<std::string> commanded = CommandedActuators(robot);
  std::vector<std::string> idle;
  for (int a = 0; a < m->nu; ++a) {
    const std::string name = ElementName(m, mjOBJ_ACTUATOR, a);
    const bool own = std::find(parts.begin(), parts.end(), BodyOfActuator(m, a)) != parts.end();
    if (!own || commanded.contains(name)) continue;
    idle.push_back(name.starts_with(robot.prefix()) ? name.substr(robot.prefix().size()) : name);
  }
  return idle;
}

}  // namespace robocell
