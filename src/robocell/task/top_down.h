// The axes of hands that point straight down. Private to task.
#pragma once

#include <cmath>
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace robocell::internal {

// Returns the axes of a grasp frame whose approach (z) points straight down, with x at an angle to
// the world's x.
inline Eigen::Matrix3d TopDown(double yaw) {
  const Eigen::Vector3d x(std::cos(yaw), std::sin(yaw), 0), z(0, 0, -1);
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return axes;
}

}  // namespace robocell::internal
