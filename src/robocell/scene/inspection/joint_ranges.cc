#include "robocell/scene/inspection/joint_ranges.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/control_modes.h"

namespace robocell::internal {

std::string Reach::text() const { return fmt::format("{:.4g} to {:.4g}", lower, upper); }

int JointRanges::Joint(const std::string& name) const {
  const int joint = FindId(m_, mjOBJ_JOINT, robot_.prefix + name);
  const bool single = joint >= 0 && (IsHinge(joint) || m_->jnt_type[joint] == mjJNT_SLIDE);
  return single ? joint : -1;
}

Reach JointRanges::RangeOf(int joint) const {
  return {m_->jnt_range[2 * joint], m_->jnt_range[2 * joint + 1]};
}

int JointRanges::ServoOf(const MoveGroupConfig& arm, int joint) const {
  for (const std::string& name : ArmActuators(arm, part_.spec.get())) {
    const int actuator = FindId(m_, mjOBJ_ACTUATOR, robot_.prefix + name);
    if (actuator >= 0 && Drives(actuator, joint)) return actuator;
  }
  return -1;
}

std::optional<Reach> JointRanges::ServoSpan(int servo) const {
  if (servo < 0 || Gear(m_, servo) == 0) return std::nullopt;
  const int input = m_->actuator_ctrladr[servo];
  if (!m_->actuator_ctrllimited[input]) return std::nullopt;
  const mjtNum* range = m_->actuator_ctrlrange + 2 * input;
  const double a = JointPos(servo, range[0]), b = JointPos(servo, range[1]);
  return Reach{std::min(a, b), std::max(a, b)};
}

double JointRanges::Ctrl(int servo, double joint_pos) const {
  const mjtNum* bias = m_->actuator_biasprm + mjNBIAS * servo;
  const mjtNum gain = m_->actuator_gainprm[mjNGAIN * servo];
  return (-bias[1] * Gear(m_, servo) * joint_pos - bias[0]) / gain;
}

std::string JointRanges::Name(mjtObj kind, int id) const {
  return ElementName(m_, kind, id).substr(robot_.prefix.size());
}

double JointRanges::JointPos(int actuator, double ctrl) const {
  const mjtNum* bias = m_->actuator_biasprm + mjNBIAS * actuator;
  const mjtNum gain = m_->actuator_gainprm[mjNGAIN * actuator];
  return -(gain * ctrl + bias[0]) / bias[1] / Gear(m_, actuator);
}

bool JointRanges::Drives(int actuator, int joint) const {
  return ActsOnJoint(m_, actuator) && m_->actuator_trnid[2 * actuator] == joint &&
         IsPositionServo(m_, actuator);
}

}  // namespace robocell::internal
