#include "robocell/robot/joint_velocity_controller.h"

#include <algorithm>
#include <cmath>

#include "robocell/robot/joint_torque_controller.h"

namespace robocell::internal {
namespace {

constexpr double kBraking = 0.1;  // s, in which the velocity at the start falls to 1/e
constexpr double kStands = 2;     // s, after which nothing is left of it

}  // namespace

std::unique_ptr<Controller> MakeJointVelocityController(MoveGroup& group) {
  return std::make_unique<JointVelocityController>(RequireArm(group, "joint_velocity"));
}

JointVelocityController::JointVelocityController(ArmGroup& arm)
    : arm_(arm),
      velocity_(std::vector<double>(arm.nv())),
      still_(arm.nv()),
      feedforward_(arm.nv()),
      q_(arm.nq()),
      qd_(arm.nv()),
      start_(arm.nv()),
      driven_(arm.nv()) {
  Reset();
}

void JointVelocityController::SetTarget(std::span<const double> velocity) {
  RequireValues([&] { return arm_.place(); }, "joint", velocity, target_size(), arm_.joint_names());
  std::copy(velocity.begin(), velocity.end(), velocity_.begin());
}

void JointVelocityController::Reset() {
  std::fill(velocity_.begin(), velocity_.end(), 0.0);
  arm_.GetJointPos(q_);
  braking_ = false;
}

void JointVelocityController::ResetTo(std::span<const double> start) {
  Reset();
  std::copy(start.begin(), start.end(), start_.begin());
  started_ = arm_.time();
  braking_ = true;
}

std::span<const double> JointVelocityController::Driven() {
  if (!braking_) return velocity_.get();
  const double passed = arm_.time() - started_;
  braking_ = passed >= 0 && passed < kStands;
  if (!braking_) return velocity_.get();
  const double left = std::exp(-passed / kBraking);
  for (size_t i = 0; i < driven_.size(); ++i) {
    if (velocity_[i] != 0) start_[i] = 0;
    driven_[i] = velocity_[i] + left * start_[i];
  }
  return driven_;
}

void JointVelocityController::Compute(std::span<double> ctrl) {
  // Writes into the port are not checked.
  RequireValues([&] { return arm_.place(); }, "joint", velocity_.get(), target_size(),
                arm_.joint_names());
  arm_.GetJointPos(q_);
  arm_.GetJointVel(qd_);
  arm_.InverseDynamics(q_, qd_, still_, feedforward_);
  const std::span<const double> velocity = Driven();
  arm_.AddResistance(q_, velocity, feedforward_);
  arm_.CtrlForJointVel(velocity, qd_, feedforward_, ctrl);
}

}  // namespace robocell::internal
