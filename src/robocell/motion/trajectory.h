// Trajectory: a path of waypoints over time, within limits of velocity, acceleration and jerk.
//
//   Trajectory motion = TimePath(result.path, {.velocity = {1.5}, .acceleration = {4}});
//   for (const std::vector<double>& q : motion.Sample(0.002)) ...
//
// Each stretch between two waypoints is a straight line in joint space, from rest to rest, in the
// least time that the limits of all joints allow (L. Berscheid and T. Kroeger, "Jerk-limited
// Real-time Trajectory Generation with Arbitrary Target States", 2021; the library ruckig). The
// configurations are exactly those of the path, so that what was checked is what moves.
//
// A value: cheap to move, no reference to anything. timed_path.h times motions by ticks instead.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace robocell {

// One value for each joint, or one for all: rad (m for slides) and seconds.
struct MotionLimits {
  std::vector<double> velocity = {1}, acceleration = {3}, jerk = {20};
};

struct TrajectoryPoint {
  std::vector<double> position, velocity, acceleration;
};

class Trajectory {
 public:
  // A trajectory that lasts no time.
  Trajectory() = default;

  double duration() const { return starts_.empty() ? 0 : starts_.back(); }  // seconds
  int n_joints() const;
  // Returns the state at a time in seconds; before the start and after the end, the rest there.
  TrajectoryPoint At(double time) const;
  // Returns the positions at 0, tick, 2 tick, ..., and at the end. Throws ArgumentError for a tick
  // that is not above 0.
  std::vector<std::vector<double>> Sample(double tick) const;

 private:
  friend Trajectory TimePath(std::span<const std::vector<double>> path, const MotionLimits& limits);
  // A stretch of constant jerk of the share of a straight line, which goes from 0 to 1.
  struct Phase {
    double start, share, speed, acceleration, jerk;  // time within the line, and values there
  };
  struct Line {
    std::vector<Phase> phases;
  };
  std::vector<std::vector<double>> points_;
  std::vector<Line> lines_;     // between the points
  std::vector<double> starts_;  // time of each point
};

// Throws ArgumentError for limits that are not above 0 and finite or whose number does not fit, and
// for waypoints of different sizes.
Trajectory TimePath(std::span<const std::vector<double>> path, const MotionLimits& limits = {});

// Returns why a path takes longer than `seconds` within the limits, naming the joint whose limits
// count most; "" if it does not.
std::string WhyTooSlow(std::span<const std::vector<double>> path, const MotionLimits& limits,
                       double seconds, std::span<const std::string> joint_names);

}  // namespace robocell
