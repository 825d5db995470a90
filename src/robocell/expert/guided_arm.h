// GuidedArm: one arm of an expert on a timed path. It gives the next joint target each tick and
// reports whether the arm has arrived at the end and whether something blocks it.
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
  // Guides the robot's arm, which is at its target. `tick`: seconds between targets.
  GuidedArm(const Robot& robot, double tick);

  void Begin();
  // Adds a leg like TimedPath::AddLeg.
  void AddLeg(JointPath points, double speed, double least);
  // Sets the target to the measured position: the arm gave way, or something pushed it.
  void TakeMeasured();
  // Sets the target of this tick, for motions that react to what happens.
  void SetTarget(const JointVector& target) { target_ = target; }
  // Returns the next target; call Settled() before, once in a tick.
  const JointVector& Next();
  const JointVector& target() const { return target_; }
  bool finished() const { return path_.finished(); }
  // Returns true if the path has ended and the arm has arrived. The arm gets some time to come to
  // rest, but not an unlimited time.
  bool Settled();
  // Returns true if the arm has been far behind its target for a while; call it once per tick.
  bool Blocked();
  // Restarts the count of blocked ticks.
  void Unblock() { lagging_ = 0; }

  int Ticks(double seconds) const;
  // Returns the shortest duration of a motion through `points` in which no servo reaches its force
  // limit, so that a held object is not shaken out of the hand; between `least` and `most` seconds.
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
