#include "robocell/robot/idle_actuators.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/control_modes.h"

namespace robocell {
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

std::vector<std::string> IdleActuators(const Robot& robot) {
  const mjModel* m = robot.scene().model();
  const std::vector<int>& parts = robot.body_ids();
  const std::set<std::string> commanded = CommandedActuators(robot);
  std::vector<std::string> idle;
  for (int a = 0; a < m->nactuator; ++a) {
    const std::string name = ElementName(m, mjOBJ_ACTUATOR, a);
    const bool own = std::find(parts.begin(), parts.end(), BodyOfActuator(m, a)) != parts.end();
    if (!own || commanded.contains(name)) continue;
    idle.push_back(name.starts_with(robot.prefix()) ? name.substr(robot.prefix().size()) : name);
  }
  return idle;
}

}  // namespace robocell
