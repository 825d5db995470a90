// Checks that the distance of a gripper's fingers, which is its opening, matches its motion.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <optional>
#include <span>
#include <string>

#include "robocell/base/error.h"
#include "robocell/diagnose/trials.h"
#include "robocell/robot/gripper_group.h"

namespace robocell::internal {
namespace {

void WarnOfMeasurement(const ActuatedGripper& gripper, const std::string& name, bool at_hinge,
                       Findings& findings) {
  try {
    GripperRange range = gripper.Measure();
    if (at_hinge) range.flat.reset();  // the same, with less advice
    for (const std::string& doubt : gripper.Doubts(range))
      findings.WarnAbout("move_groups." + name + ".fingers", doubt);
  } catch (const Error&) {
    // Reported by the code that needs the distances.
  }
}

// A gripper's opening is the distance of its fingers.
void WarnOfHinges(const Robot& robot, Findings& findings) {
  const CompiledScene& compiled = *robot.scene().compiled();
  const mjModel* m = compiled.model();
  const std::span<const double> qpos(robot.scene().data()->qpos, static_cast<size_t>(m->nq));
  for (const std::string& name : robot.group_names()) {
    const auto* gripper = dynamic_cast<const ActuatedGripper*>(&robot.group(name));
    if (!gripper) continue;
    const FingerPair pair{.hand = gripper->hand_body(),
                          .fingers = {gripper->finger(0), gripper->finger(1)}};
    const std::optional<Jaw> jaw = FindJaw(m, pair);
    const bool at_hinge = jaw && IsMeasuredAtItsHinge(m, qpos, pair, *jaw);
    if (at_hinge) {
      findings.WarnAbout("move_groups." + name + ".fingers",
                         HowToNameTips(compiled, compiled.robot(robot.name()), pair, *jaw));
    }
    WarnOfMeasurement(*gripper, name, at_hinge, findings);
  }
}

// If the file sets the controls, it determines which of them are openings.
void WarnOfEarlyMeeting(const Robot& robot, Findings& findings) {
  for (const auto& [name, config] : robot.config().move_groups.entries()) {
    if (!config->ctrl || !robot.has_group(name)) continue;
    const auto* gripper = dynamic_cast<const ActuatedGripper*>(&robot.group(name));
    if (!gripper) continue;
    double meets = 0;
    try {
      meets = gripper->Measure().meets;
    } catch (const Error&) {
      continue;  // reported by the code that needs the distances
    }
    if (meets == 0) continue;
    const auto [open, closed] = *config->ctrl;
    const double at = closed + meets * (open - closed);
    findings.WarnAbout(
        "move_groups." + name + ".ctrl",
        fmt::format("the fingers meet at control {:.3g}, {:.0f} % of the way from closed to "
                    "open: smaller openings all look closed. Leave `ctrl` out, so that "
                    "openings are shares of the measured distance, or write {{open: {}, "
                    "closed: {:.3g}}}",
                    at, 100 * meets, open, at));
  }
}

}  // namespace

void TryFingerDistance(Robot& robot, const TrialOptions&, Findings& findings) {
  WarnOfHinges(robot, findings);
  WarnOfEarlyMeeting(robot, findings);
}

}  // namespace robocell::internal
