// Applies the overrides of a robot's configuration to its model, and adds the TCP site.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "robocell/base/suggestions.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/control_modes.h"
#include "robocell/scene/edit_values.h"
#include "robocell/scene/robot_parts.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

void OverrideServo(const RobotConfig& config, mjsActuator* actuator) {
  SetServoGains({.kp = config.stiffness, .kv = config.damping}, actuator);
  if (config.force_limit) {
    actuator->forcelimited = mjLIMITED_TRUE;
    actuator->forcerange[0] = -*config.force_limit;
    actuator->forcerange[1] = *config.force_limit;
  }
}

void OverrideArm(const RobotConfig& config, const MoveGroupConfig& arm, Part& robot,
                 CompileLog& log) {
  for (const std::string& name : ArmActuators(arm, robot.spec.get())) {
    mjsElement* element = FindSpecElement(robot.spec.get(), mjOBJ_ACTUATOR, name);
    if (!element) continue;  // reported with all other names after compiling
    if (IsPositionServo(mjs_asActuator(element))) {
      OverrideServo(config, mjs_asActuator(element));
    } else {
      log.Problem(
          robot.place,
          fmt::format(
              "stiffness, damping and force_limit are for position servos; actuator '{}' is none",
              name),
          config.stiffness ? "stiffness"
          : config.damping ? "damping"
                           : "force_limit");
    }
  }
}

}  // namespace

void ApplyOverrides(const RobotConfig& config, Part& robot, CompileLog& log) {
  if (config.gravcomp) {
    for (mjsElement* body : SpecElements(robot.spec.get(), mjOBJ_BODY))
      mjs_asBody(body)->gravcomp = *config.gravcomp ? 1 : 0;
  }
  if (!config.stiffness && !config.damping && !config.force_limit) return;
  for (const auto& [name, group] : config.move_groups.entries()) {
    if (group->kind == MoveGroupKind::kArm) OverrideArm(config, *group, robot, log);
  }
}

std::optional<std::string> AddTcpSite(const RobotConfig& config, Part& robot, CompileLog& log) {
  if (!config.attachment_site) return std::nullopt;
  mjSpec* spec = robot.spec.get();
  mjsElement* flange = FindSpecElement(spec, mjOBJ_SITE, *config.attachment_site);
  if (!flange) {
    log.Problem(robot.place,
                "attachment_site: " + NoSuchName("the robot", "site", *config.attachment_site,
                                                 SpecNames(spec, mjOBJ_SITE)),
                "attachment_site");
    return std::nullopt;
  }
  if (!config.tcp_offset) return std::nullopt;
  std::string name = "tcp";
  while (FindSpecElement(spec, mjOBJ_SITE, name)) name += "_offset";
  mjsSite* site = mjs_addSite(mjs_getParent(flange), nullptr);
  SetSpecName(site->element, name, robot.place);
  SetPose(site, PoseInParent(flange) * *config.tcp_offset);
  site->group = mjs_asSite(flange)->group;
  return name;
}

}  // namespace robocell::internal
