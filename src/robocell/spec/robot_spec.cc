#include "robocell/spec/robot_spec.h"

#include <algorithm>

#include "robocell/spec/validate.h"

namespace robocell {

const BaseConfig& RobotSpec::EffectiveBase() const {
  static const BaseConfig kFixed;
  return base ? *base : config ? config->base : kFixed;
}

bool RobotSpec::can_switch_to(CtrlMode mode) const {
  if (!control_modes) return mode != CtrlMode::kVelocity;
  return mode == CtrlMode::kPosition ||
         std::find(control_modes->begin(), control_modes->end(), mode) != control_modes->end();
}

void RobotSpec::Validate(Problems& problems) const {
  ValidatePlacement(euler, quat, problems);
  if (name) ValidateNamePart(*name, "name", problems);
  ValidateAttachments(attachments, problems);
  if (!part_of.empty() && !config)
    problems.AddAt("config", "is not set; part_of says where the robot is, not what it is");
  if (path.empty() && !config)
    problems.AddAt("path", "is empty: give the robot's model file, or a config");
  if (!path.empty() && config)
    problems.AddAt("path", "is set together with config, whose model is used; keep one of them");
}

}  // namespace robocell
