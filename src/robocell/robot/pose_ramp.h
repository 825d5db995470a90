// Private to robot: a pose that moves to a goal along a straight line and the shortest arc, with
// limits of speed and acceleration. Pure arithmetic without the engine.
//
//   PoseRamp ramp(start);
//   for (;;) ramp.Advance(goal, {.linear_speed = 0.5, ...}, seconds);
//
// It brakes in time and ends exactly at the goal. Metres, radians, seconds; axes of the poses'
// reference frame. No allocation.
#pragma once

#include <Eigen/Core>

#include "robocell/math/pose.h"

namespace robocell::internal {

class PoseRamp {
 public:
  struct Limits {
    double linear_speed, angular_speed;                // m/s, rad/s
    double linear_acceleration, angular_acceleration;  // m/s^2, rad/s^2
  };

  PoseRamp() { Start(Pose()); }
  explicit PoseRamp(const Pose& at) { Start(at); }

  // Places it there, at rest.
  void Start(const Pose& at);
  // The goal may differ each time; the velocity turns to it within the limits.
  void Advance(const Pose& goal, const Limits& limits, double seconds);

  const Pose& pose() const { return pose_; }
  const Eigen::Vector3d& linear_velocity() const { return linear_; }
  const Eigen::Vector3d& angular_velocity() const { return angular_; }
  // Returns the changes of the velocities in the last tick, divided by its length.
  const Eigen::Vector3d& linear_acceleration() const { return linear_change_; }
  const Eigen::Vector3d& angular_acceleration() const { return angular_change_; }

 private:
  Pose pose_;
  Eigen::Vector3d linear_, angular_, linear_change_, angular_change_;
};

}  // namespace robocell::internal
