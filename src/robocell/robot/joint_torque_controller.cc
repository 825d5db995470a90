#include "robocell/robot/joint_torque_controller.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/error.h"

namespace robocell::internal {

ArmGroup& RequireArm(MoveGroup& group, std::string_view controller) {
  if (auto* arm = dynamic_cast<ArmGroup*>(&group)) return *arm;
  throw ArgumentError(
      fmt::format("{}: controller '{}' drives arms that have a chain; this group "
                  "is none",
                  group.place(), controller));
}

std::unique_ptr<Controller> MakeJointTorqueController(MoveGroup& group) {
  return std::make_unique<JointTorqueController>(RequireArm(group, "joint_torque"));
}

JointTorqueController::JointTorqueController(ArmGroup& arm)
    : arm_(arm), torque_(std::vector<double>(arm.nv())), held_(arm.nv()), q_(arm.nq()) {
  Reset();
}

void JointTorqueController::SetTarget(std::span<const double> torque) {
  RequireValues([&] { return arm_.place(); }, "joint", torque, target_size(), arm_.joint_names());
  std::copy(torque.begin(), torque.end(), torque_.begin());
  commanded_ = true;
}

void JointTorqueController::Reset() {
  arm_.GetJointPos(q_);
  arm_.GravityTorques(q_, torque_.get());
  std::copy(torque_.begin(), torque_.end(), held_.begin());
  commanded_ = false;
}

void JointTorqueController::Compute(std::span<double> ctrl) {
  // Writes into the port are not checked.
  RequireValues([&] { return arm_.place(); }, "joint", torque_.get(), target_size(),
                arm_.joint_names());
  arm_.GetJointPos(q_);
  if (!beyond_.warned()) WarnOfStrained();
  arm_.CtrlForJointTorque(torque_.get(), ctrl);
}

// The engine clips by itself.
void JointTorqueController::WarnOfStrained() {
  for (size_t i = arm_.FindStrained(torque_.get(), 0); i < torque_.size();
       i = arm_.FindStrained(torque_.get(), i + 1)) {
    if (!IsCommanded(i)) continue;
    beyond_.Watch(torque_[i], arm_.torque_limit(i), [&] {
      return fmt::format("{}: the torque of joint '{}'", arm_.place(), arm_.joint_names()[i]);
    });
  }
}

}  // namespace robocell::internal
