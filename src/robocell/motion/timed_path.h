// TimedPath: joint targets over time, one per policy tick. Legs start and end at rest (fifth-order
// time scaling) and pass their waypoints without stopping. It also computes how slow a leg must be
// for the servos that follow it.
#pragma once

#include <vector>

#include "robocell/motion/joint_path.h"
#include "robocell/mujoco/forward.h"
#include "robocell/robot/move_group.h"

namespace robocell {

class TimedPath {
 public:
  // The largest speed of a leg, relative to its mean speed.
  static constexpr double kPeakSpeed = 1.875;

  // `tick`: seconds between targets.
  TimedPath(const JointVector& start, double tick) : tick_(tick), end_(start) {}

  // Adds a leg through `points` from the present end of the path. It is slow enough that no joint
  // is faster than `speed` on the straight line from its start to its end (rad/s or m/s), and lasts
  // at least `least` seconds.
  void AddLeg(JointPath points, double speed, double least);

  // Returns the next target; at the end the last one again.
  JointVector Next();
  bool finished() const { return leg_ >= legs_.size(); }
  const JointVector& end() const { return end_; }
  // Returns the number of remaining ticks.
  int remaining() const;

 private:
  struct Leg {
    JointPath points;
    int ticks;
  };
  double tick_;
  JointVector end_;
  std::vector<Leg> legs_;
  size_t leg_ = 0;
  int done_ = 0;  // ticks of the present leg
};

// Computes how far the target of a servo may jump at once before the servo is at its force limit.
//
// Targets change once per policy tick. A stiff servo with a low limit answers a large jump with its
// limit, and with the opposite limit one engine step later: the hand shakes, and a lightly held
// object slides out. A motion that must avoid this is timed by this function.
//
// Returns for each joint of an arm, in order, the jump in rad or m that takes its servo from rest
// to the force limit of actuator or joint. It is infinite without a limit, if it cannot be
// computed, and for an arm of other actuators.
std::vector<double> ServoJumps(const mjModel* model, const MoveGroup& arm);

// Returns the least duration in seconds of a leg of a TimedPath through `points` in which no target
// jumps by more than `jumps`, with a target every `tick` seconds.
double SecondsForJumps(const JointPath& points, const std::vector<double>& jumps, double tick);

}  // namespace robocell
