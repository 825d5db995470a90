// How far a tip is from where it should be. For the solvers of this folder.
#pragma once

#include <cmath>

#include "robocell/kinematics/transform.h"

namespace robocell {

// Rotation vector of a rotation matrix, angle in [0, pi]; exact to rounding for small angles and
// near pi.
inline Eigen::Vector3d RotationVector(const Eigen::Matrix3d& r) {
  const Eigen::Vector3d sine(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0),
                             r(1, 0) - r(0, 1));  // 2 sin(angle) axis
  const double s = 0.5 * sine.norm(), c = 0.5 * (r.trace() - 1);
  // angle / sin(angle): what the series leaves out is below rounding
  if (s < 1e-3 && c > 0) return sine * (0.5 + s * s * (1.0 / 12 + s * s * (3.0 / 80)));
  if (s > 1e-7) return sine * (std::atan2(s, c) / (2 * s));
  Eigen::Index longest;  // half a turn: r + I = 2 axis axis^T
  (r.diagonal()).maxCoeff(&longest);
  Eigen::Vector3d axis = r.col(longest);
  axis[longest] += 1;
  return axis.normalized() * std::atan2(s, c);
}

// The length of that vector: the angle of the rotation.
inline double RotationAngle(const Eigen::Matrix3d& r) {
  const Eigen::Vector3d sine(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  const double s = 0.5 * sine.norm(), c = 0.5 * (r.trace() - 1);
  if (s < 1e-3 && c > 0) return s * (1 + s * s * (1.0 / 6 + s * s * (3.0 / 40)));
  return std::atan2(s, c);
}

// The twist that takes the tip to the target in one unit of time, in the axes of the base.
struct PoseError {
  Eigen::Vector3d linear;
  Eigen::Vector3d angular;
};

inline PoseError ErrorTo(const Transform& target, const Transform& tip) {
  return {target.translation - tip.translation,
          RotationVector(target.rotation * tip.rotation.transpose())};
}

}  // namespace robocell
