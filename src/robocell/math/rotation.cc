#include "robocell/math/rotation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {
namespace {

constexpr double kTolerance = 1e-6;  // allowed error of unit length and orthonormality

double Dot(const Quaternion& a, const Quaternion& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

Eigen::Vector3d VectorPart(const Quaternion& q) { return {q[0], q[1], q[2]}; }

bool NeedsOtherSign(const Quaternion& q) {
  if (q[3] != 0) return q[3] < 0;
  for (int i = 0; i < 3; ++i) {
    if (q[i] != 0) return q[i] < 0;
  }
  return false;
}

// Adding 0 turns -0 into 0.
Quaternion Scaled(const Quaternion& q, double factor) {
  return {q[0] * factor + 0, q[1] * factor + 0, q[2] * factor + 0, q[3] * factor + 0};
}

// Converts a quaternion near unit length to canonical form. One of unit length up to rounding keeps
// its bits.
Quaternion Canonical(const Quaternion& q) {
  const double square = Dot(q, q);
  const double sign = NeedsOtherSign(q) ? -1 : 1;
  return Scaled(q, std::abs(square - 1) < 2e-15 ? sign : sign / std::sqrt(square));
}

// S. W. Shepperd, "Quaternion from rotation matrix", 1978: divides by the largest of the four
// numbers.
Quaternion Shepperd(const Eigen::Matrix3d& r) {
  const double trace = r.trace();
  int i = 0;
  if (r(1, 1) > r(0, 0)) i = 1;
  if (r(2, 2) > r(i, i)) i = 2;
  Quaternion q;
  if (trace >= r(i, i)) {
    q = {r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1), 1 + trace};
  } else {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    q[i] = 1 + 2 * r(i, i) - trace;
    q[j] = r(j, i) + r(i, j);
    q[k] = r(k, i) + r(i, k);
    q[3] = r(k, j) - r(j, k);
  }
  return Scaled(q, 1 / std::sqrt(Dot(q, q)));
}

}  // namespace

Quaternion UnitQuaternion(const Quaternion& q) {
  const double length = std::sqrt(Dot(q, q));
  if (!(std::abs(length - 1) <= kTolerance)) {
    throw ArgumentError(fmt::format(
        "quaternion [{}, {}, {}, {}] (xyzw) has length {}, not 1. Divide it by its length first.",
        q[0], q[1], q[2], q[3], length));
  }
  return Canonical(q);
}

Quaternion QuaternionFromWxyz(const double wxyz[4]) {
  return UnitQuaternion({wxyz[1], wxyz[2], wxyz[3], wxyz[0]});
}

Quaternion QuaternionToWxyz(const Quaternion& q) { return {q[3], q[0], q[1], q[2]}; }

Quaternion QuaternionFromMatrix(const Eigen::Matrix3d& rotation) {
  // Works entry by entry: a matrix product is a call that costs more than all of this.
  const Eigen::Vector3d x = rotation.col(0), y = rotation.col(1), z = rotation.col(2);
  const double error =
      std::max({std::abs(x.dot(x) - 1), std::abs(y.dot(y) - 1), std::abs(z.dot(z) - 1),
                std::abs(x.dot(y)), std::abs(x.dot(z)), std::abs(y.dot(z))}) +
      0 * rotation.sum();  // NaN for what is not finite
  if (!(error <= kTolerance)) {
    if (!rotation.allFinite())
      throw ArgumentError("rotation matrix is not finite: it has a number that is NaN or infinite");
    throw ArgumentError(fmt::format(
        "rotation matrix is not orthonormal: R^T * R differs from the identity by {}", error));
  }
  if (x.cross(y).dot(z) < 0) {
    throw ArgumentError("rotation matrix has determinant -1: it mirrors. Flip one of its axes.");
  }
  return Canonical(Shepperd(rotation));
}

Eigen::Matrix3d MatrixFromQuaternion(const Quaternion& q) {
  const auto [x, y, z, w] = q;
  Eigen::Matrix3d r;
  r << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
  return r;
}

Quaternion QuaternionProduct(const Quaternion& a, const Quaternion& b) {
  const auto [ax, ay, az, aw] = a;
  const auto [bx, by, bz, bw] = b;
  return Canonical({aw * bx + ax * bw + ay * bz - az * by,  //
                    aw * by - ax * bz + ay * bw + az * bx,  //
                    aw * bz + ax * by - ay * bx + az * bw,  //
                    aw * bw - ax * bx - ay * by - az * bz});
}

Quaternion QuaternionInverse(const Quaternion& q) { return Canonical({-q[0], -q[1], -q[2], q[3]}); }

Eigen::Vector3d Rotate(const Quaternion& q, const Eigen::Vector3d& v) {
  const Eigen::Vector3d u = VectorPart(q);
  const Eigen::Vector3d t = 2 * u.cross(v);
  return v + q[3] * t + u.cross(t);
}

Quaternion QuaternionFromRotvec(const Eigen::Vector3d& rotvec) {
  const double angle = rotvec.norm();
  // sin(a / 2) / a is 1/2 to rounding for small a, where the norm may even underflow.
  const double scale = angle < 1e-8 ? 0.5 : std::sin(angle / 2) / angle;
  return Canonical({rotvec[0] * scale, rotvec[1] * scale, rotvec[2] * scale, std::cos(angle / 2)});
}

Eigen::Vector3d RotvecFromQuaternion(const Quaternion& q) {
  const Quaternion c = Canonical(q);
  const Eigen::Vector3d v = VectorPart(c);
  const double sine = v.norm();
  return v * (sine < 1e-8 ? 2 / c[3] : 2 * std::atan2(sine, c[3]) / sine);
}

Quaternion QuaternionFromRpy(const Eigen::Vector3d& rpy) {
  const double cr = std::cos(rpy[0] / 2), sr = std::sin(rpy[0] / 2);
  const double cp = std::cos(rpy[1] / 2), sp = std::sin(rpy[1] / 2);
  const double cy = std::cos(rpy[2] / 2), sy = std::sin(rpy[2] / 2);
  return Canonical({sr * cp * cy - cr * sp * sy,  //
                    cr * sp * cy + sr * cp * sy,  //
                    cr * cp * sy - sr * sp * cy,  //
                    cr * cp * cy + sr * sp * sy});
}

Eigen::Vector3d RpyFromQuaternion(const Quaternion& q) {
  const Eigen::Matrix3d r = MatrixFromQuaternion(q);
  const double cos_pitch = std::hypot(r(0, 0), r(1, 0));
  const bool gimbal_lock = cos_pitch < 1e-12;
  const double roll = gimbal_lock ? 0 : std::atan2(r(2, 1), r(2, 2));
  // Computes yaw after undoing the roll: however inaccurate roll is near gimbal lock, the three
  // angles together give the rotation back.
  const double c = std::cos(roll), s = std::sin(roll);
  const double yaw = std::atan2(s * r(0, 2) - c * r(0, 1), c * r(1, 1) - s * r(1, 2));
  return {roll, std::atan2(-r(2, 0), cos_pitch), yaw};
}

double AngleBetween(const Quaternion& a, const Quaternion& b) {
  const Quaternion difference = QuaternionProduct(QuaternionInverse(a), b);
  return 2 * std::atan2(VectorPart(difference).norm(), difference[3]);
}

Quaternion Slerp(const Quaternion& a, const Quaternion& b, double s) {
  if (s == 1) return Canonical(b);
  const Eigen::Vector3d whole = RotvecFromQuaternion(QuaternionProduct(QuaternionInverse(a), b));
  return QuaternionProduct(a, QuaternionFromRotvec(s * whole));
}

Quaternion RandomQuaternion(Rng& rng) {
  for (;;) {
    const Quaternion q = {rng.Normal(), rng.Normal(), rng.Normal(), rng.Normal()};
    const double length = std::sqrt(Dot(q, q));
    if (length > 1e-3) return Canonical(Scaled(q, 1 / length));
  }
}

Eigen::Matrix3d Skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d s;
  s << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return s;
}

}  // namespace robocell
