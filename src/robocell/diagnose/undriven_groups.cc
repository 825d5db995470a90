// Finds the parts of a robot that no command reaches: groups without a controller, actuators
// without a group.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <optional>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/function_name.h"
#include "robocell/base/suggestions.h"
#include "robocell/diagnose/trials.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/suction_gripper.h"
#include "robocell/robot/unused_groups.h"
#include "robocell/scene/actuator_kind.h"

namespace robocell::internal {
namespace {

// Describes the first actuator of the group that acts on a body, site or tendon: no controller is
// made for these, whatever the robot's file says. Unset if there is none.
std::optional<std::string> ActsElsewhere(const Robot& robot, const MoveGroup& group) {
  const mjModel* m = robot.scene().model();
  std::optional<std::string> first;
  for (const std::string& name : group.actuator_names()) {
    const int id = FindId(m, mjOBJ_ACTUATOR, name);
    if (id < 0 || ActsOnJoint(m, id)) return std::nullopt;
    const bool sticks = m->actuator_trntype[id] == mjTRN_BODY;
    if (!first) {
      first = fmt::format("'{}' is {}", name,
                          sticks ? "an adhesion actuator" : DescribeActuator(m, id));
    }
  }
  return first;
}

std::string AboutUndriven(const Robot& robot, const MoveGroup& group, const std::string& why) {
  const std::string set = CppAndPythonName("Scene::SetActuatorCtrl");
  if (const auto first = ActsElsewhere(robot, group)) {
    return fmt::format(
        "{}, which moves no joint, so that there is no controller for it. Command "
        "it by its actuator with {}; environments, experts and records leave it out{}",
        *first, set,
        SuctionGripper::IsMadeOf(robot.scene().model(), group.actuator_names())
            ? ". With `kind: gripper` it is a gripper that sticks, and they command it"
            : "");
  }
  return fmt::format(
      "{}. Without one nothing commands it: environments, experts and records leave "
      "it out, and its controls stay as at home unless you write them ({})",
      why, set);
}

// Arms and grippers without a drive are errors (robot/validate_config.h).
void WarnOfUndriven(const Robot& robot, Findings& findings) {
  for (const std::string& name : robot.group_names()) {
    const MoveGroup& group = robot.group(name);
    if (group.kind() != MoveGroupKind::kGeneric || group.nu() == 0 || robot.is_driven(name))
      continue;
    try {
      robot.controller(name);
    } catch (const NotFoundError& error) {
      findings.WarnAbout("move_groups." + name, AboutUndriven(robot, group, error.what()));
    }
  }
}

void WarnOfIdle(const Robot& robot, Findings& findings) {
  const std::vector<std::string> idle = IdleActuators(robot);
  if (idle.empty()) return;
  findings.WarnAbout("move_groups",
                     fmt::format("no move group has the actuators {}: nothing will command them",
                                 ListNames(idle)));
}

}  // namespace

void TryUndrivenGroups(Robot& robot, const TrialOptions&, Findings& findings) {
  WarnOfUndriven(robot, findings);
  WarnOfIdle(robot, findings);
}

}  // namespace robocell::internal
