#include "robocell/math/pose.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string_view>

#include <Eigen/LU>
#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {
namespace {

const Eigen::Vector3d& Finite(const Eigen::Vector3d& v, std::string_view what) {
  if (!v.allFinite()) {
    throw ArgumentError(
        fmt::format("pose: the {} [{}, {}, {}] is not finite", what, v[0], v[1], v[2]));
  }
  return v;
}

void RequireHomogeneous(const Eigen::Matrix4d& m) {
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw ArgumentError(
        fmt::format("pose: the last row of a 4x4 matrix must be [0, 0, 0, 1], not [{}, {}, {}, {}]",
                    m(3, 0), m(3, 1), m(3, 2), m(3, 3)));
  }
}

double Limit(double limit, std::string_view what) {
  if (!(limit >= 0))
    throw ArgumentError(fmt::format("pose: cannot limit the {} to {}", what, limit));
  return limit;
}

}  // namespace

Pose::Pose(const Eigen::Vector3d& translation, const Quaternion& quaternion)
    : translation_(Finite(translation, "translation")), quaternion_(UnitQuaternion(quaternion)) {}

Pose::Pose(const Eigen::Vector3d& translation) : translation_(Finite(translation, "translation")) {}

Pose::Pose(const Eigen::Vector3d& translation, const Quaternion& quaternion, Unchecked)
    : translation_(translation), quaternion_(quaternion) {}

Pose Pose::FromRpy(const Eigen::Vector3d& translation, const Eigen::Vector3d& rpy) {
  return Pose(translation, QuaternionFromRpy(Finite(rpy, "rpy")));
}

Pose Pose::FromRotvec(const Eigen::Vector3d& translation, const Eigen::Vector3d& rotvec) {
  return Pose(translation, QuaternionFromRotvec(Finite(rotvec, "rotation vector")));
}

Pose Pose::FromWxyz(const double translation[3], const double quaternion_wxyz[4]) {
  return Pose(Eigen::Vector3d(translation), QuaternionFromWxyz(quaternion_wxyz));
}

Pose Pose::FromTranslationAndMatrix(const double translation[3],
                                    const double row_major_rotation[9]) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return Pose(Eigen::Vector3d(translation),
              Eigen::Matrix3d(Eigen::Map<const RowMajor>(row_major_rotation)));
}

Pose Pose::FromMatrix(const Eigen::Matrix4d& homogeneous) {
  RequireHomogeneous(homogeneous);
  return Pose(Eigen::Vector3d(homogeneous.topRightCorner<3, 1>()),
              homogeneous.topLeftCorner<3, 3>());
}

void Pose::ToWxyz(double translation[3], double quaternion_wxyz[4]) const {
  const Quaternion q = this->quaternion_wxyz();
  std::copy_n(translation_.data(), 3, translation);
  std::copy(q.begin(), q.end(), quaternion_wxyz);
}

Quaternion Pose::quaternion_wxyz() const { return QuaternionToWxyz(quaternion_); }
Eigen::Matrix3d Pose::rotation() const { return MatrixFromQuaternion(quaternion_); }
Eigen::Vector3d Pose::rpy() const { return RpyFromQuaternion(quaternion_); }
Eigen::Vector3d Pose::rotvec() const { return RotvecFromQuaternion(quaternion_); }
double Pose::angle() const { return AngleBetween({0, 0, 0, 1}, quaternion_); }

Eigen::Matrix4d Pose::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation();
  m.topRightCorner<3, 1>() = translation_;
  return m;
}

std::array<double, 6> Pose::xyzrpy() const {
  const Eigen::Vector3d angles = rpy();
  return {translation_[0], translation_[1], translation_[2], angles[0], angles[1], angles[2]};
}

Pose Pose::inverse() const {
  const Quaternion q = QuaternionInverse(quaternion_);
  return Pose(-Rotate(q, translation_), q, Unchecked());
}

Pose Pose::operator*(const Pose& other) const {
  return Pose(*this * other.translation_, QuaternionProduct(quaternion_, other.quaternion_),
              Unchecked());
}

Eigen::Vector3d Pose::operator*(const Eigen::Vector3d& point) const {
  return translation_ + Rotate(quaternion_, point);
}

Pose Pose::interpolate(const Pose& to, double s) const {
  if (s == 1) return to;
  return Pose(translation_ + s * (to.translation_ - translation_),
              Slerp(quaternion_, to.quaternion_, s), Unchecked());
}

Pose Pose::limit_translation(double metres) const {
  // The norm of the longest is infinite.
  const double norm = translation_.norm();
  const double length = std::isfinite(norm) ? norm : translation_.stableNorm();
  if (length <= Limit(metres, "translation")) return *this;
  return Pose(translation_ * (metres / length), quaternion_, Unchecked());
}

Pose Pose::limit_rotation(double radians) const {
  const double whole = angle();
  if (whole <= Limit(radians, "rotation")) return *this;
  return Pose(translation_, QuaternionFromRotvec(rotvec() * (radians / whole)), Unchecked());
}

bool Pose::is_close(const Pose& other, double rotation_tolerance,
                    double translation_tolerance) const {
  return AngleBetween(quaternion_, other.quaternion_) <= rotation_tolerance &&
         (translation_ - other.translation_).norm() <= translation_tolerance;
}

bool Pose::operator==(const Pose& other) const {
  return translation_ == other.translation_ && quaternion_ == other.quaternion_;
}

bool IsFinite(const Pose& pose) {
  const Quaternion& q = pose.quaternion();
  return pose.translation().allFinite() && std::isfinite(q[0] + q[1] + q[2] + q[3]);
}

std::ostream& operator<<(std::ostream& out, const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Quaternion& q = pose.quaternion();
  return out << fmt::format("Pose(translation=[{}, {}, {}], quaternion=[{}, {}, {}, {}])", t[0],
                            t[1], t[2], q[0], q[1], q[2], q[3]);
}

Eigen::Matrix<double, 6, 1> PoseDifference(const Pose& from, const Pose& to) {
  Eigen::Matrix<double, 6, 1> difference;
  difference << to.translation() - from.translation(),
      RotvecFromQuaternion(
          QuaternionProduct(to.quaternion(), QuaternionInverse(from.quaternion())));
  return difference;
}

Pose Integrate(const Pose& pose, const Eigen::Matrix<double, 6, 1>& difference) {
  const Quaternion turn = QuaternionFromRotvec(difference.tail<3>());
  return Pose(pose.translation() + difference.head<3>(),
              QuaternionProduct(turn, pose.quaternion()));
}

}  // namespace robocell
