// The error of a tip's pose. For the solvers of this folder.
#pragma once

#include <cmath>

#include "robocell/kinematics/transform.h"

namespace robocell::internal {

// Returns angle / (2 sin(angle)) for the square of a sine up to 1/16: the best polynomial, to
// 1e-18.
inline double HalfAngleBySine(double sine2) {
  constexpr double kTerms[] = {
      7.3655469927763283789e-3, 6.7873010341084569891e-3, 8.6889940985615293479e-3,
      1.1185608951832380554e-2, 1.5190982486694193298e-2, 2.2321428446032969688e-2,
      3.7500000000765836325e-2, 8.3333333333331535368e-2, 0.5};
  // Even and odd powers are computed independently.
  const double sine4 = sine2 * sine2;
  double even = kTerms[0], odd = kTerms[1];
#pragma GCC unroll 4
  for (int k = 2; k < 8; k += 2) {
    even = even * sine4 + kTerms[k];
    odd = odd * sine4 + kTerms[k + 1];
  }
  return even * sine4 + kTerms[8] + odd * sine2;
}

// Returns the rotation vector of a rotation matrix, angle in [0, pi]; exact to rounding for small
// angles and near pi.
inline Eigen::Vector3d RotationVector(const Eigen::Matrix3d& r) {
  const Eigen::Vector3d sine(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0),
                             r(1, 0) - r(0, 1));  // 2 sin(angle) axis
  const double s = 0.5 * sine.norm(), c = 0.5 * (r.trace() - 1);
  if (s < 0.25 && c > 0) return sine * HalfAngleBySine(s * s);
  if (s > 1e-7) return sine * (std::atan2(s, c) / (2 * s));
  Eigen::Index longest;  // half a turn: r + I = 2 axis axis^T
  (r.diagonal()).maxCoeff(&longest);
  Eigen::Vector3d axis = r.col(longest);
  axis[longest] += 1;
  return axis.normalized() * std::atan2(s, c);
}

// Returns the length of that vector: the angle of the rotation.
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

}  // namespace robocell::internal
