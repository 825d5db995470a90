// Pose: a rigid transform in SE(3), immutable. Frames: `X_AB` is the pose of B in A, and
// X_AC = X_AB * X_BC.
//
// Quaternions are xyzw in the whole API. Lengths are metres, angles radians. Roll-pitch-yaw is
// extrinsic xyz, that is R = Rz(yaw) * Ry(pitch) * Rx(roll). The stored quaternion is of unit
// length with w >= 0.
//
//   Pose tcp_in_world = base_in_world * tcp_in_base;
//   Pose target(Eigen::Vector3d(0.4, 0, 0.3), Quaternion{1, 0, 0, 0});   // tool pointing down
//   Pose step = Pose::FromRpy({0, 0, 0.01}, {0, 0, 0.1});
//
// No function allocates, and any thread may call them.
#pragma once

#include <array>
#include <iosfwd>

#include <Eigen/Core>

#include "robocell/math/rotation.h"

namespace robocell {

// A square matrix of that size, or an expression that gives one.
template <typename T, int size>
concept EigenMatrix = (T::RowsAtCompileTime == size) && (T::ColsAtCompileTime == size);

class Pose {
 public:
  // The identity.
  Pose() = default;
  // Translation in metres and quaternion xyzw. A quaternion within 1e-6 of unit length is
  // normalised. Throws ArgumentError for any other, and for a number that is not finite.
  Pose(const Eigen::Vector3d& translation, const Quaternion& quaternion);
  explicit Pose(const Eigen::Vector3d& translation);
  // Throws ArgumentError unless the rotation is orthonormal with determinant +1 within 1e-6.
  template <EigenMatrix<3> Rotation>
  Pose(const Eigen::Vector3d& translation, const Rotation& rotation)
      : Pose(translation, QuaternionFromMatrix(rotation)) {}
  // 4x4 homogeneous matrix; the last row must be 0 0 0 1.
  template <EigenMatrix<4> Matrix>
  explicit Pose(const Matrix& matrix) : Pose(FromMatrix(matrix)) {}

  static Pose FromRpy(const Eigen::Vector3d& translation, const Eigen::Vector3d& rpy);
  static Pose FromRotvec(const Eigen::Vector3d& translation, const Eigen::Vector3d& rotvec);
  // Uses MuJoCo's order. Only for code at the engine's boundary.
  static Pose FromWxyz(const double translation[3], const double quaternion_wxyz[4]);
  // The inverse: writes into the engine's arrays.
  void ToWxyz(double translation[3], double quaternion_wxyz[4]) const;
  static Pose FromTranslationAndMatrix(const double translation[3],
                                       const double row_major_rotation[9]);
  static Pose FromMatrix(const Eigen::Matrix4d& homogeneous);

  const Eigen::Vector3d& translation() const { return translation_; }
  const Quaternion& quaternion() const { return quaternion_; }  // xyzw
  Quaternion quaternion_wxyz() const;
  Eigen::Matrix3d rotation() const;
  Eigen::Vector3d rpy() const;     // extrinsic xyz; at gimbal lock roll is 0
  Eigen::Vector3d rotvec() const;  // axis * angle, angle in [0, pi]
  Eigen::Matrix4d matrix() const;
  std::array<double, 6> xyzrpy() const;
  double angle() const;  // rotation angle in [0, pi]

  Pose inverse() const;
  Pose operator*(const Pose& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const;

  // s = 0 gives *this, s = 1 gives `to`: straight line for the translation, shortest arc for the
  // rotation. Other s continue the motion.
  Pose interpolate(const Pose& to, double s) const;
  // Returns the same pose with the translation shortened to at most `metres`, or the rotation to at
  // most `radians`; direction and axis stay. Throws ArgumentError for a negative limit.
  Pose limit_translation(double metres) const;
  Pose limit_rotation(double radians) const;

  // Returns true if the angle between the rotations and the distance are both within their
  // tolerance (radians, metres).
  bool is_close(const Pose& other, double rotation_tolerance, double translation_tolerance) const;
  bool operator==(const Pose& other) const;  // exact

 private:
  struct Unchecked {};
  Pose(const Eigen::Vector3d& translation, const Quaternion& quaternion, Unchecked);

  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
  Quaternion quaternion_ = {0, 0, 0, 1};
};

// Returns true if all numbers are finite. Constructors reject other poses; arithmetic may overflow.
bool IsFinite(const Pose& pose);

std::ostream& operator<<(std::ostream& out, const Pose& pose);

// Returns the twist X_AB from `from` to `to` in one unit of time, six numbers with the linear part
// first, expressed in the frame of both poses: (translation difference, rotation vector of to.R *
// from.R^T).
Eigen::Matrix<double, 6, 1> PoseDifference(const Pose& from, const Pose& to);
// The inverse: moves `pose` by such a twist.
Pose Integrate(const Pose& pose, const Eigen::Matrix<double, 6, 1>& difference);

}  // namespace robocell
