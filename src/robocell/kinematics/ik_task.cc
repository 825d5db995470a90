#include "robocell/kinematics/ik_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robocell/base/error.h"
#include "robocell/kinematics/pose_error.h"

namespace robocell::internal {
namespace {

using Weights = std::array<double, 3>;

int CountZeros(const Weights& weights) {
  return static_cast<int>(std::count(weights.begin(), weights.end(), 0.0));
}

bool IsWhole(const Weights& weights) { return weights == Weights{1, 1, 1}; }

// Returns true for a whole pose without weights: the usual query, which skips the rest.
bool IsPlain(const IkOptions& options) {
  return !options.position_only && !options.axis && IsWhole(options.position_weights) &&
         IsWhole(options.rotation_weights);
}

Eigen::Matrix3d Diagonal(const Weights& weights) {
  return Eigen::Vector3d(weights[0], weights[1], weights[2]).asDiagonal();
}

// Returns two rows across the axis, and one that counts nothing.
Eigen::Matrix3d RowsAcross(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d across = axis.unitOrthogonal();
  Eigen::Matrix3d rows = Eigen::Matrix3d::Zero();
  rows.row(0) = across;
  rows.row(1) = axis.cross(across);
  return rows;
}

// Returns the rotation vector from the first of two unit vectors to the second.
Eigen::Vector3d SwingBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d sine = from.cross(to);
  const double s = sine.norm(), angle = std::atan2(s, from.dot(to));
  if (s > 1e-9) return sine * (angle / s);
  return angle < 1 ? sine : Eigen::Vector3d(from.unitOrthogonal() * angle);
}

void RequireWeights(std::string_view what, const Weights& weights) {
  for (const double w : weights) {
    if (w >= 0 && std::isfinite(w)) continue;
    throw ArgumentError(fmt::format(
        "inverse kinematics: {} holds {}; each must be 0 (any value will do) or more", what, w));
  }
}

}  // namespace

IkTask::IkTask(const IkOptions& options) : plain(IsPlain(options)), cone(options.cone) {
  if (plain) return;
  position_only = options.position_only || CountZeros(options.rotation_weights) == 3;
  whole_position =
      *std::min_element(options.position_weights.begin(), options.position_weights.end()) >= 1;
  linear = Diagonal(options.position_weights);
  angular = Diagonal(options.rotation_weights);
  if (position_only) {
    angular.setZero();
  } else if (options.axis) {
    swing = true;
    axis = options.axis->stableNormalized();  // squares may overflow
    angular = RowsAcross(axis);
  } else if (CountZeros(options.rotation_weights) == 1) {
    swing = true;
    for (int i = 0; i < 3; ++i) axis[i] = options.rotation_weights[i] == 0 ? 1 : 0;
  }
  rows = 3 - CountZeros(options.position_weights);
  if (!position_only) rows += swing ? (cone > 0 ? 0 : 2) : 3 - CountZeros(options.rotation_weights);
}

IkTask::Errors IkTask::ErrorsOf(const Transform& target, const Transform& tip) const {
  const PoseError error = ErrorTo(target, tip);
  Errors errors;
  const Eigen::Matrix3d to_target = target.rotation.transpose();
  const Eigen::Vector3d off = linear * (to_target * error.linear);
  errors.position = off.stableNorm();
  if (position_only) {
    errors.rotation = error.angular.norm();
    return errors;
  }
  Eigen::Vector3d turn = error.angular;
  if (swing) {
    turn = SwingBetween(tip.rotation * axis, target.rotation * axis);
    const double angle = turn.norm();
    if (cone > 0) turn *= angle > cone ? (angle - cone) / angle : 0;
  }
  const Eigen::Vector3d counted = angular * (to_target * turn);
  errors.rotation = counted.norm();
  return errors;
}

void RequireIkTask(const IkOptions& options) {
  if (IsPlain(options) && options.cone == 0) return;
  RequireWeights("position_weights", options.position_weights);
  RequireWeights("rotation_weights", options.rotation_weights);
  const bool weighs = !IsWhole(options.rotation_weights);
  if (CountZeros(options.position_weights) == 3 &&
      (options.position_only || CountZeros(options.rotation_weights) == 3)) {
    throw ArgumentError(
        "inverse kinematics: all weights are 0, so that the target has no residual");
  }
  if (options.position_only && (weighs || options.axis)) {
    throw ArgumentError(
        fmt::format("inverse kinematics: position_only and {} contradict each other; leave "
                    "one out",
                    options.axis ? "axis" : "rotation_weights"));
  }
  if (options.axis && weighs) {
    throw ArgumentError(
        "inverse kinematics: axis and rotation_weights both constrain the rotation; leave "
        "one out");
  }
  if (options.axis && !(options.axis->allFinite() && options.axis->stableNorm() > 1e-9)) {
    const Eigen::Vector3d& a = *options.axis;
    throw ArgumentError(
        fmt::format("inverse kinematics: axis is ({:g}, {:g}, {:g}); it must be a direction in the "
                    "tip's frame, as (0, 0, 1)",
                    a.x(), a.y(), a.z()));
  }
  const bool swing = options.axis || CountZeros(options.rotation_weights) == 1;
  if (!(options.cone >= 0 && options.cone < std::numbers::pi)) {
    throw ArgumentError(fmt::format(
        "inverse kinematics: cone is {}; it must be an angle from 0 to less than pi, rad",
        options.cone));
  }
  if (options.cone > 0 && (!swing || options.position_only)) {
    throw ArgumentError(
        fmt::format("inverse kinematics: cone is {} rad, but no axis is given that may be off by "
                    "it. Give axis, as (0, 0, 1)",
                    options.cone));
  }
}

}  // namespace robocell::internal
