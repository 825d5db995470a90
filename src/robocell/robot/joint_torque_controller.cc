#include "robocell/robot/joint_torque_controller.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/error.h"

namespace robocell {

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
    : arm_(arm), torque_(arm.nv()), q_(arm.nq()), limits_(arm.torque_limits()) {
  Reset();
}

void JointTorqueController::SetTarget(std::span<const double> torque) {
  CheckValues([&] { return arm_.place(); }, "joint", torque, target_size(), arm_.joint_names());
  std::copy(torque.begin(), torque.end(), torque_.begin());
}

void JointTorqueController::Reset() {
  arm_.GetJointPos(q_);
  arm_.GravityTorques(q_, torque_);
}

void JointTorqueController::Compute(std::span<double> ctrl) {
  arm_.GetJointPos(q_);
  for (size_t i = 0; i < torque_.size(); ++i) {  // to tell: the engine cuts off by itself
    beyond_.Clamp(torque_[i], limits_[i], [&] {
      return fmt::format("{}: the torque of joint '{}'", arm_.place(), arm_.joint_names()[i]);
    });
  }
  arm_.CtrlForJointTorque(torque_, ctrl);
}

}  // namespace robocell
