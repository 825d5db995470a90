#include "robocell/robot/pose_ramp.h"

#include <algorithm>
#include <cmath>

namespace robocell::internal {
namespace {

// Share of the acceleration that planned braking uses; the rest corrects the speed if ticks are
// long.
constexpr double kPlannedBraking = 0.7;
constexpr double kNothing = 1e-12;  // m or rad; rounding

// Returns the velocity after a tick, with `displacement` still to go. It changes by at most the
// acceleration, so that its length never exceeds both the old one and `speed`.
Eigen::Vector3d NextVelocity(const Eigen::Vector3d& velocity, const Eigen::Vector3d& displacement,
                             double speed, double acceleration, double seconds) {
  const double distance = displacement.norm() < kNothing ? 0 : displacement.norm();
  const double braking = std::sqrt(2 * kPlannedBraking * acceleration * distance);
  const double wanted = std::min({speed, braking, distance / seconds});
  const Eigen::Vector3d direct =
      distance > 0 ? Eigen::Vector3d(displacement * (wanted / distance)) : Eigen::Vector3d::Zero();
  const Eigen::Vector3d change = direct - velocity;
  const double most = acceleration * seconds, size = change.norm();
  return size <= most ? direct : Eigen::Vector3d(velocity + change * (most / size));
}

}  // namespace

void PoseRamp::Start(const Pose& at) {
  pose_ = at;
  for (Eigen::Vector3d* v : {&linear_, &angular_, &linear_change_, &angular_change_}) v->setZero();
}

void PoseRamp::Advance(const Pose& goal, const Limits& limits, double seconds) {
  if (!(seconds > 0)) return;
  const Pose left = pose_.inverse() * goal;
  const Eigen::Vector3d displacement = goal.translation() - pose_.translation();
  const Eigen::Vector3d turn = pose_.rotation() * left.rotvec();
  const Eigen::Vector3d linear = linear_, angular = angular_;
  linear_ =
      NextVelocity(linear, displacement, limits.linear_speed, limits.linear_acceleration, seconds);
  angular_ =
      NextVelocity(angular, turn, limits.angular_speed, limits.angular_acceleration, seconds);
  linear_change_ = (linear_ - linear) / seconds;
  angular_change_ = (angular_ - angular) / seconds;
  const bool is_there = (linear_ * seconds - displacement).norm() < kNothing;
  const bool is_turned = (angular_ * seconds - turn).norm() < kNothing;
  const Eigen::Vector3d at =
      is_there ? goal.translation() : pose_.translation() + linear_ * seconds;
  if (is_turned) {
    pose_ = Pose(at, goal.quaternion());
  } else {
    const Pose turned =
        Pose::FromRotvec({0, 0, 0}, angular_ * seconds) * Pose({0, 0, 0}, pose_.quaternion());
    pose_ = Pose(at, turned.quaternion());
  }
}

}  // namespace robocell::internal
