#include "robocell/robot/joint_position_controller.h"

#include <algorithm>
#include <cmath>

#include "robocell/robot/arm_group.h"
#include "robocell/robot/gripper_opening_controller.h"
#include "robocell/robot/move_group.h"

namespace robocell {

std::unique_ptr<Controller> MakeJointPositionController(MoveGroup& group) {
  if (auto* gripper = dynamic_cast<GripperGroup*>(&group)) {
    return std::make_unique<internal::GripperOpeningController>(*gripper);
  }
  return std::make_unique<JointPositionController>(group);
}

JointPositionController::JointPositionController(MoveGroup& group)
    : group_(group),
      servos_(dynamic_cast<const ServoGroup*>(&group)),
      target_(group.joint_pos()),
      held_(target_.begin(), target_.end()),
      within_(target_.size()),
      limits_(CheckedJointPosLimits(group)) {
  std::vector<double> ctrl(group.nu());
  group.CtrlForJointPos(target_.get(), ctrl);  // throws at once if the group has no servos
}

void JointPositionController::SetTarget(std::span<const double> target) {
  RequireValues([&] { return group_.place(); }, "joint", target, target_size(),
                group_.joint_names());
  std::copy(target.begin(), target.end(), target_.begin());
  commanded_ = true;
}

void JointPositionController::Reset() {
  group_.GetJointPos(held_);
  ResetTo(held_);
}

void JointPositionController::ResetTo(std::span<const double> servos) {
  std::copy(servos.begin(), servos.end(), held_.begin());
  std::copy(servos.begin(), servos.end(), target_.begin());
  commanded_ = false;
}

bool JointPositionController::GetSteadyTarget(std::span<const double> q, std::span<const double> v,
                                              std::span<const double> gravity,
                                              std::span<const double> resistance,
                                              std::span<double> out) const {
  const auto* arm = dynamic_cast<const ArmGroup*>(&group_);
  if (!arm) return false;
  for (size_t i = 0; i < out.size(); ++i) out[i] = gravity[i] + resistance[i];
  arm->JointPosForTorque(q, v, out, out);
  return std::all_of(out.begin(), out.end(), [](double x) { return std::isfinite(x); });
}

void JointPositionController::Compute(std::span<double> ctrl) {
  // Writes into the port are not checked.
  RequireValues([&] { return group_.place(); }, "joint", target_.get(), target_size(),
                group_.joint_names());
  // Other code may have written to the model.
  if (servos_) {
    servos_->GetJointPosLimits(limits_);
  } else {
    limits_ = CheckedJointPosLimits(group_);
  }
  for (size_t i = 0; i < target_.size(); ++i) {
    within_[i] = std::clamp(target_[i], limits_[i].lower, limits_[i].upper);
    if (within_[i] == target_[i] || !IsCommanded(i)) continue;
    beyond_.Watch(target_[i], limits_[i], [&] {
      const std::vector<std::string>& names = group_.joint_names();
      return group_.place() + ": joint " +
             (names.size() == target_.size() ? "'" + names[i] + "'" : std::to_string(i));
    });
  }
  group_.CtrlForJointPos(within_, ctrl);
  if (servos_ && !beyond_.warned()) WarnOfCutCtrl(ctrl);
}

void JointPositionController::WarnOfCutCtrl(std::span<const double> ctrl) {
  for (auto cut = servos_->FindCutCtrl(within_, ctrl, 0); cut;
       cut = servos_->FindCutCtrl(within_, ctrl, cut->actuator + 1)) {
    if (!IsCommanded(cut->joint)) continue;
    beyond_.Watch(cut->wanted, cut->range, [&] {
      return group_.place() + ": actuator '" + group_.actuator_names()[cut->actuator] +
             "', by its ctrlrange,";
    });
  }
}

}  // namespace robocell
