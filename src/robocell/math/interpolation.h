// Time scaling of a straight motion: minimum-jerk and trapezoidal, for joints and for poses. It is
// not a planner: it knows nothing of obstacles, and limits are those of one motion from rest to
// rest.
//
//   const double duration = JointMoveDuration(from, to, max_velocity, max_acceleration);
//   const double s = MinimumJerk(time, duration).position;
//   InterpolateJoints(from, to, s, q);            // all joints start and arrive together
//   const Pose now = start.interpolate(goal, s);  // straight line, shortest turn
//
// Times are seconds. Nothing allocates, and all functions may be called from any thread.
#pragma once

#include <span>

#include "robocell/math/pose.h"

namespace robocell {

// Position, velocity (per s) and acceleration (per s^2) of one coordinate; the unit of the position
// is the caller's.
struct CoordinateState {
  double position = 0;
  double velocity = 0;
  double acceleration = 0;
};

// Goes from 0 at time 0 to 1 at `duration`, with velocity and acceleration 0 at both ends and the
// least integral of squared jerk (T. Flash and N. Hogan, "The coordination of arm movements",
// 1985). At rest before and after. With duration 0 it jumps to 1 at time 0. Throws ArgumentError
// for a negative duration.
CoordinateState MinimumJerk(double time, double duration);

// Returns the shortest duration in which a minimum-jerk motion over `distance` (of either sign)
// keeps both limits. Limits must be > 0 and the distance finite (ArgumentError); infinity means no
// limit.
double MinimumJerkDuration(double distance, double max_velocity, double max_acceleration);

// Trapezoidal velocity: full acceleration, constant speed, full braking; a triangle for a short
// distance. The fastest motion from rest to rest under the two limits.
class TrapezoidalMotion {
 public:
  // `distance` has either sign and is finite; limits are finite and > 0 (ArgumentError otherwise).
  TrapezoidalMotion(double distance, double max_velocity, double max_acceleration);

  double duration() const { return cruise_end_ + ramp_; }
  // Returns the position from 0 to `distance`; at rest before time 0 and after duration().
  CoordinateState at(double time) const;

 private:
  double distance_;
  double acceleration_;  // acceleration, with the sign of the distance
  double ramp_;          // duration of the acceleration, and of the braking
  double cruise_end_;
};

// Computes (1 - s) * from + s * to, exactly `from` at s = 0 and `to` at s = 1. All three have the
// same size (ArgumentError); `out` may be `from` or `to`.
void InterpolateJoints(std::span<const double> from, std::span<const double> to, double s,
                       std::span<double> out);

// Returns the shortest common duration in which minimum-jerk motions of all joints keep their
// limits: rad/s and rad/s^2, or m. All four have the same size (ArgumentError).
double JointMoveDuration(std::span<const double> from, std::span<const double> to,
                         std::span<const double> max_velocity,
                         std::span<const double> max_acceleration);

// Limits of a motion of a pose; infinity means none.
struct PoseMoveLimits {
  double linear_velocity;       // m/s
  double linear_acceleration;   // m/s^2
  double angular_velocity;      // rad/s
  double angular_acceleration;  // rad/s^2
};

// Returns the shortest duration in which from.interpolate(to, MinimumJerk(t, duration).position)
// keeps the limits.
double PoseMoveDuration(const Pose& from, const Pose& to, const PoseMoveLimits& limits);

}  // namespace robocell
