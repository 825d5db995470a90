// For tests only: random vectors, poses and twists from a stream of numbers.
#pragma once

#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/math/pose.h"

namespace robocell {

// Each component in [-size, size].
inline Eigen::Vector3d RandomVector(Rng& rng, double size = 1) {
  const double x = rng.Uniform(-size, size), y = rng.Uniform(-size, size);
  return Eigen::Vector3d(x, y, rng.Uniform(-size, size));
}

// Returns unit vectors, with all directions equally likely.
inline Eigen::Vector3d RandomDirection(Rng& rng) {
  const double x = rng.Normal(), y = rng.Normal();
  return Eigen::Vector3d(x, y, rng.Normal()).normalized();
}

// Returns poses up to 2 m away along each axis, with any orientation.
inline Pose RandomPose(Rng& rng) {
  const Eigen::Vector3d translation = RandomVector(rng, 2);
  return Pose(translation, RandomQuaternion(rng));
}

}  // namespace robocell
