// GuidedArm: one arm of an expert on a timed path: its next joint target each tick, whether it has
// arrived at the end, and whether something blocks it.
//
//   GuidedArm arm(robot, tick);
//   arm.Begin();                         // a new path, from the last target
//   arm.AddLeg(points, speed, seconds);
//   each tick: if (arm.Blocked()) ...; if (arm.Settled()) ...; target = arm.Next();
#pragma once

#include <optional>
#include <vector>

#include "robocell/motion/joint_path.h"
#include "robocell/motion/timed_path.h"
#include "robocell/robot/robot.h"

namespace robocell {

class GuidedArm {
 public:
  // For the robot's arm, which is at its target. `tick`: seconds between targets.
  GuidedArm(const Robot& robot, double tick);

  void Begin();
  // As TimedPath::AddLeg.
  void AddLeg(JointPath points, double speed, double least);
  // Takes where the arm is for its target: it gave way, or something pushed it.
  void TakeMeasured();
  // The next target; call Settled() before, once in a tick.
  const JointVector& Next();
  const JointVector& target() const { return target_; }
  bool finished() const { return path_.finished(); }
  // Whether the path has ended and the arm has arrived. It gets some time to come to rest, but not
  // an unlimited time.
  bool Settled();
  // Whether the arm has been far behind its target for a while; call it once per tick.
  bool Blocked();
  // From now on it is not.
  void Unblock() { lagging_ = 0; }

  int Ticks(double seconds) const;
  // How long a motion through `points` takes at least for no servo to reach its force limit, so
  // that what is held is not shaken out of the hand; between `least` and `most` seconds.
  double GentleSeconds(const JointPath& points, double least, double most) const;

 private:
  double Lag() const;
  bool Arrived() const;

  Robot robot_;
  double tick_;
  JointVector target_;
  TimedPath path_;
  std::vector<double> arrival_tolerances_;
  int waited_ = 0;   // ticks since the path ended
  int lagging_ = 0;  // ticks in a row that the arm did not follow
};

}  // namespace robocell
