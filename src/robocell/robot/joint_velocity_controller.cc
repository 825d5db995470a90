#include "robocell/robot/joint_velocity_controller.h"

#include <algorithm>

#include "robocell/robot/joint_torque_controller.h"

namespace robocell {

std::unique_ptr<Controller> MakeJointVelocityController(MoveGroup& group) {
  return std::make_unique<JointVelocityController>(RequireArm(group, "joint_velocity"));
}

JointVelocityController::JointVelocityController(ArmGroup& arm)
    : arm_(arm),
      velocity_(std::vector<double>(arm.nv())),
      still_(arm.nv()),
      feedforward_(arm.nv()),
      q_(arm.nq()),
      qd_(arm.nv()) {
  Reset();
}

void JointVelocityController::SetTarget(std::span<const double> velocity) {
  CheckValues([&] { return arm_.place(); }, "joint", velocity, target_size(), arm_.joint_names());
  std::copy(velocity.begin(), velocity.end(), velocity_.begin());
}

void JointVelocityController::Reset() {
  std::fill(velocity_.begin(), velocity_.end(), 0.0);
  arm_.GetJointPos(q_);
}

void JointVelocityController::Compute(std::span<double> ctrl) {
  // The port is written to without a check.
  CheckValues([&] { return arm_.place(); }, "joint", velocity_.get(), target_size(),
              arm_.joint_names());
  arm_.GetJointPos(q_);
  arm_.GetJointVel(qd_);
  arm_.InverseDynamics(q_, qd_, still_, feedforward_);
  arm_.AddResistance(q_, velocity_.get(), feedforward_);
  arm_.CtrlForJointVel(velocity_.get(), qd_, feedforward_, ctrl);
}

}  // namespace robocell
