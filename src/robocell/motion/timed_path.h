// TimedPath: joint targets over time, one per policy tick: legs that start and end at rest
// (fifth-order time scaling) and pass their way points without stopping.
#pragma once

#include <vector>

#include "robocell/motion/joint_path.h"

namespace robocell {

class TimedPath {
 public:
  // The largest speed of a leg, relative to its mean speed.
  static constexpr double kPeakSpeed = 1.875;

  // `tick`: seconds between targets.
  TimedPath(const JointVector& start, double tick) : tick_(tick), end_(start) {}

  // A leg through `points` from where the path ends so far, as slow as needed for no joint to be
  // faster than `speed` on the straight from its start to its end (rad/s or m/s) but no shorter
  // than `least` seconds.
  void AddLeg(JointPath points, double speed, double least);

  // The next target; the last one again at the end.
  JointVector Next();
  bool finished() const { return leg_ >= legs_.size(); }
  const JointVector& end() const { return end_; }
  // Ticks that are left.
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

}  // namespace robocell
