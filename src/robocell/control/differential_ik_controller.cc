#include "robocell/control/differential_ik_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robocell/base/error.h"
#include "robocell/robot/joint_torque_controller.h"

namespace robocell {
namespace {

constexpr double kMostSeconds = 0.1;  // longest tick; avoids a jump after a pause

[[maybe_unused]] const bool kDifferentialIkRegistered = [] {
  RegisterController("differential_ik", [](MoveGroup& group) -> std::unique_ptr<Controller> {
    return std::make_unique<DifferentialIkController>(
        internal::RequireArm(group, "differential_ik"));
  });
  return true;
}();

}  // namespace

DifferentialIkController::DifferentialIkController(ArmGroup& arm) : arm_(arm), servos_(arm) {
  options_.max_speed = JointVector(arm_.chain().n_joints(), std::numbers::pi);
  Reset();
}

void DifferentialIkController::SetTarget(std::span<const double> twist) {
  RequireValues([&] { return arm_.place(); }, "twist", twist, target_size());
  std::copy(twist.begin(), twist.end(), target_.begin());
}

void DifferentialIkController::SetTwist(const Twist& twist) {
  const Eigen::Matrix<double, 6, 1> numbers = twist.vector();
  SetTarget({numbers.data(), 6});
}

Twist DifferentialIkController::twist() const {
  return Twist::FromVector(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(target_.data()));
}

void DifferentialIkController::SetMaxSpeed(std::span<const double> speed) {
  RequireValues([&] { return arm_.place(); }, "joint", speed, arm_.nq(), arm_.joint_names());
  for (std::size_t i = 0; i < speed.size(); ++i) {
    if (speed[i] > 0) continue;
    throw ArgumentError(
        fmt::format("{}: the largest speed of joint '{}' cannot be {}; it must be "
                    "above 0",
                    arm_.place(), arm_.joint_names()[i], speed[i]));
  }
  options_.max_speed = JointVector(speed);
}

void DifferentialIkController::SetPosture(std::span<const double> q) {
  RequireValues([&] { return arm_.place(); }, "joint", q, arm_.nq(), arm_.joint_names());
  options_.posture = JointVector(q);
}

void DifferentialIkController::SetPostureRate(double per_second) {
  if (!(per_second >= 0 && std::isfinite(per_second))) {
    throw ArgumentError(
        fmt::format("{}: the rate of the posture cannot be {}; it must be 0 or more", arm_.place(),
                    per_second));
  }
  options_.posture_rate = per_second;
}

void DifferentialIkController::Reset() {
  servos_.Reset();
  HoldServos();
}

void DifferentialIkController::ResetTo(std::span<const double> servos) {
  servos_.ResetTo(servos);
  HoldServos();
}

void DifferentialIkController::HoldServos() {
  options_.posture = JointVector(servos_.target());
  target_.fill(0);
  slower_ = false;
  time_ = arm_.time();
}

void DifferentialIkController::Compute(std::span<double> ctrl) {
  const double now = arm_.time();
  const double seconds = std::clamp(now - time_, 0.0, kMostSeconds);
  time_ = now;
  if (seconds > 0) {
    // Writes into the port are not checked.
    RequireValues([&] { return arm_.place(); }, "twist", target_, target_size());
    options_.seconds = seconds;
    if (frame() == TwistFrame::kWorld)
      options_.base_in_world =
          arm_.leaf_frame_to_world().rotation() * arm_.leaf_frame_to_robot().rotation().transpose();
    const std::span<double> q = servos_.command_port();
    const DifferentialIkResult found = DifferentialIk(arm_.chain(), q, twist(), options_);
    for (int i = 0; i < found.velocity.size(); ++i) q[i] += seconds * found.velocity[i];
    slower_ = found.slower;
  }
  servos_.Compute(ctrl);
}

}  // namespace robocell
