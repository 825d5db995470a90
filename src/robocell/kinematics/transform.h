// Transform: rotation matrix and translation, the form that the inner loops of this folder use.
//
// Not for public interfaces: those use Pose, which is checked and normalised.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robocell/math/pose.h"

namespace robocell {

// X_AB: maps coordinates in B to coordinates in A.
struct Transform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  // Works column by column: a call of a matrix product costs more than the product.
  EIGEN_STRONG_INLINE Transform operator*(const Transform& other) const {
    Transform product;
    for (int c = 0; c < 3; ++c) product.rotation.col(c) = Turned(other.rotation.col(c));
    product.translation = *this * other.translation;
    return product;
  }
  EIGEN_STRONG_INLINE Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return translation + Turned(point);
  }
  Transform inverse() const {
    return {rotation.transpose(), -(rotation.transpose() * translation)};
  }
  Pose pose() const { return Pose(translation, rotation); }

 private:
  EIGEN_STRONG_INLINE Eigen::Vector3d Turned(const Eigen::Vector3d& v) const {
    return rotation.col(0) * v.x() + rotation.col(1) * v.y() + rotation.col(2) * v.z();
  }
};

inline Transform ToTransform(const Pose& pose) { return {pose.rotation(), pose.translation()}; }

}  // namespace robocell
