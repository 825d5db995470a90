// Twist and Wrench: the motion of a body and the load on it, as plain values, and changes of their
// frame.
//
// A twist (or wrench) "in A" has two properties: its axes are A's, and its reference point is A's
// origin. `linear` is the velocity of the body's point that coincides with the reference point, in
// m/s, `angular` the angular velocity in rad/s; `force` is in N, `torque` about the reference point
// in Nm. Six numbers in a row are linear then angular, force then torque.
//
// One operation per meaning:
//   V_A = Transformed(X_AB, V_B)   other axes and other reference point (the adjoint)
//   Rotated(R_AB, V)               other axes, same reference point
//   Shifted(V, p)                  same axes, reference point moved by p (in those axes)
//
// An F/T sensor's reading as force and torque at the TCP:
//   const Wrench at_tcp = Transformed(X_TcpSensor, measured);
//
// Power(V, F) is the same in every frame. Nothing allocates, and all functions may be called from
// any thread.
#pragma once

#include <Eigen/Core>

#include "robocell/math/pose.h"

namespace robocell {

struct Twist {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();

  static Twist FromVector(const Eigen::Matrix<double, 6, 1>& linear_angular);
  Eigen::Matrix<double, 6, 1> vector() const;
  bool operator==(const Twist& other) const = default;  // exact
};

struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();

  static Wrench FromVector(const Eigen::Matrix<double, 6, 1>& force_torque);
  Eigen::Matrix<double, 6, 1> vector() const;
  bool operator==(const Wrench& other) const = default;  // exact
};

Twist operator+(const Twist& a, const Twist& b);
Twist operator-(const Twist& a, const Twist& b);
Twist operator*(double factor, const Twist& twist);
Wrench operator+(const Wrench& a, const Wrench& b);
Wrench operator-(const Wrench& a, const Wrench& b);
Wrench operator*(double factor, const Wrench& wrench);

// Transforms a twist or wrench from frame B to frame A.
Twist Transformed(const Pose& X_AB, const Twist& in_B);
Wrench Transformed(const Pose& X_AB, const Wrench& in_B);

// Rotates the axes from B to A and keeps the reference point.
Twist Rotated(const Quaternion& R_AB, const Twist& twist);
Wrench Rotated(const Quaternion& R_AB, const Wrench& wrench);

// Moves the reference point by `offset` and keeps the axes.
Twist Shifted(const Twist& twist, const Eigen::Vector3d& offset);
Wrench Shifted(const Wrench& wrench, const Eigen::Vector3d& offset);

// Returns the power in watts; both must be in the same frame.
double Power(const Twist& twist, const Wrench& wrench);

// Returns the matrix of Transformed for twists: V_A.vector() = AdjointMatrix(X_AB) * V_B.vector().
// For wrenches it is AdjointMatrix(X_AB.inverse()).transpose().
Eigen::Matrix<double, 6, 6> AdjointMatrix(const Pose& X_AB);

}  // namespace robocell
