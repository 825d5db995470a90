#include "robocell/kinematics/common_normal.h"

#include <cmath>

namespace robocell {
namespace {

// Sines of the angle between two axes. Below the first they are parallel, up to rounding. Below the
// second their common normal is too far away.
constexpr double kParallel = 1e-14, kNearlyParallel = 0.02;

double AngleOf(const Eigen::Vector3d& direction, const Transform& frame) {
  return std::atan2(frame.rotation.col(1).dot(direction), frame.rotation.col(0).dot(direction));
}

}  // namespace

std::optional<CommonNormal> CommonNormalOf(const Transform& step) {
  CommonNormal link;
  const Eigen::Vector3d old_axis = Eigen::Vector3d::UnitZ(), new_axis = step.rotation.col(2);
  const Eigen::Vector3d cross = old_axis.cross(new_axis);
  const double sine = cross.norm(), cosine = new_axis.z();
  const Eigen::Vector3d& t = step.translation;
  Eigen::Vector3d normal;
  if (sine <= kParallel) {
    normal = Eigen::Vector3d(t.x(), t.y(), 0);
    normal = normal.norm() > 0 ? normal.normalized() : Eigen::Vector3d::UnitX();
    link.cos_twist = std::copysign(1, cosine);
    link.shift_before = t.z();
  } else if (sine < kNearlyParallel) {
    return std::nullopt;
  } else {
    normal = cross / sine;
    link.cos_twist = cosine;
    link.sin_twist = sine;
    link.shift_after = (t.dot(new_axis) - cosine * t.z()) / (sine * sine);
    link.shift_before = t.z() - link.shift_after * cosine;
  }
  link.length = t.dot(normal);
  link.angle_before = AngleOf(normal, {});
  link.angle_after = -AngleOf(normal, step);
  return link;
}

}  // namespace robocell
