// Transform: rotation matrix and translation, the form in which the inner loops of this folder
// compute.
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

  Transform operator*(const Transform& other) const {
    return {rotation * other.rotation, translation + rotation * other.translation};
  }
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return translation + rotation * point;
  }
  Transform inverse() const {
    return {rotation.transpose(), -(rotation.transpose() * translation)};
  }
  Pose pose() const { return Pose(translation, rotation); }
};

inline Transform ToTransform(const Pose& pose) { return {pose.rotation(), pose.translation()}; }

}  // namespace robocell
