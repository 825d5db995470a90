#include "robocell/math/twist.h"

#include <Eigen/Geometry>

namespace robocell {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

Vector6d Stacked(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  Vector6d both;
  both << first, second;
  return both;
}

}  // namespace

Twist Twist::FromVector(const Vector6d& v) { return {v.head<3>(), v.tail<3>()}; }
Vector6d Twist::vector() const { return Stacked(linear, angular); }

Wrench Wrench::FromVector(const Vector6d& v) { return {v.head<3>(), v.tail<3>()}; }
Vector6d Wrench::vector() const { return Stacked(force, torque); }

Twist operator+(const Twist& a, const Twist& b) {
  return {a.linear + b.linear, a.angular + b.angular};
}
Twist operator-(const Twist& a, const Twist& b) {
  return {a.linear - b.linear, a.angular - b.angular};
}
Twist operator*(double factor, const Twist& twist) {
  return {factor * twist.linear, factor * twist.angular};
}
Wrench operator+(const Wrench& a, const Wrench& b) {
  return {a.force + b.force, a.torque + b.torque};
}
Wrench operator-(const Wrench& a, const Wrench& b) {
  return {a.force - b.force, a.torque - b.torque};
}
Wrench operator*(double factor, const Wrench& wrench) {
  return {factor * wrench.force, factor * wrench.torque};
}

// The vector from B's origin to A's, in A, is -X_AB.translation().
Twist Transformed(const Pose& X_AB, const Twist& in_B) {
  return Shifted(Rotated(X_AB.quaternion(), in_B), -X_AB.translation());
}
Wrench Transformed(const Pose& X_AB, const Wrench& in_B) {
  return Shifted(Rotated(X_AB.quaternion(), in_B), -X_AB.translation());
}

Twist Rotated(const Quaternion& R_AB, const Twist& twist) {
  return {Rotate(R_AB, twist.linear), Rotate(R_AB, twist.angular)};
}
Wrench Rotated(const Quaternion& R_AB, const Wrench& wrench) {
  return {Rotate(R_AB, wrench.force), Rotate(R_AB, wrench.torque)};
}

Twist Shifted(const Twist& twist, const Eigen::Vector3d& offset) {
  return {twist.linear + twist.angular.cross(offset), twist.angular};
}
Wrench Shifted(const Wrench& wrench, const Eigen::Vector3d& offset) {
  return {wrench.force, wrench.torque + wrench.force.cross(offset)};
}

double Power(const Twist& twist, const Wrench& wrench) {
  return twist.linear.dot(wrench.force) + twist.angular.dot(wrench.torque);
}

Eigen::Matrix<double, 6, 6> AdjointMatrix(const Pose& X_AB) {
  const Eigen::Matrix3d rotation = X_AB.rotation();
  Eigen::Matrix<double, 6, 6> adjoint;
  adjoint << rotation, Skew(X_AB.translation()) * rotation, Eigen::Matrix3d::Zero(), rotation;
  return adjoint;
}

}  // namespace robocell
