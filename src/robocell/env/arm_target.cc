#include "robocell/env/arm_target.h"

#include <algorithm>
#include <cmath>

#include "robocell/base/units.h"

namespace robocell::internal {
namespace {

constexpr double kShortest = 1e-6;  // shortest quaternion that has a direction

double Length(std::span<const double> q) {
  return std::hypot(q[0], q[1], std::hypot(q[2], q[3]));  // its squares do not overflow
}

// Normalises to unit length. A power of two scales first, which rounds nothing, because the length
// of the longest quaternion overflows a double.
Quaternion Normalised(std::span<const double> q) {
  double largest = 0;
  for (const double x : q) largest = std::max(largest, std::abs(x));
  Quaternion unit;
  for (size_t i = 0; i < 4; ++i) unit[i] = std::ldexp(q[i], -std::ilogb(largest));
  const double length = Length(unit);
  for (double& x : unit) x /= length;
  return unit;
}

}  // namespace

// The length of large numbers may overflow.
bool HasDirection(std::span<const double> quaternion) {
  const auto is_long = [](double x) { return std::abs(x) >= kShortest; };
  return std::ranges::any_of(quaternion, is_long) || Length(quaternion) >= kShortest;
}

Pose MovedBy(const Pose& tcp, const Pose& delta) {
  return Pose(tcp.translation() + delta.translation(),
              QuaternionProduct(delta.quaternion(), tcp.quaternion()));
}

Pose LimitedStep(const Pose& from, const Pose& to, const StepLimit& limit) {
  const Pose delta(to.translation() - from.translation(),
                   QuaternionProduct(to.quaternion(), QuaternionInverse(from.quaternion())));
  const bool near = delta.translation().norm() <= limit.translation;
  if (near && delta.angle() <= limit.rotation) return to;
  return MovedBy(from, delta.limit_translation(limit.translation).limit_rotation(limit.rotation));
}

void LimitJointStep(std::span<const double> from, double limit, std::span<double> to) {
  for (size_t i = 0; i < to.size(); ++i)
    to[i] = std::clamp(to[i], from[i] - limit, from[i] + limit);
}

void PutTquat(const Pose& pose, std::span<double> out) {
  std::copy_n(pose.translation().data(), 3, out.begin());
  std::copy_n(pose.quaternion().begin(), 4, out.begin() + 3);
}

void ObserveTquat(const Pose& pose, std::span<double> out) {
  PutTquat(pose, out);
  for (double& x : out.subspan(3, 4)) x = std::clamp(x, -1.0, 1.0);
}

double ObservedTurn(double position, double most) {
  return std::abs(position) <= most ? position : std::remainder(position, 2 * kPi);
}

Pose PoseOfAction(ControlMode mode, std::span<const double> action) {
  const Eigen::Vector3d translation(action[0], action[1], action[2]);
  if (mode == ControlMode::kCartesianTrpy)
    return Pose::FromRpy(translation, {action[3], action[4], action[5]});
  const std::span<const double> q = action.subspan(3, 4);
  if (!HasDirection(q)) return Pose(translation);
  return Pose(translation, Normalised(q));
}

}  // namespace robocell::internal
