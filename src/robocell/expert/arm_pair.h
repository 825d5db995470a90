// ArmPair: two arms of one robot on one timed path, each with its gripper. Both are on their way, at
// the same place of the path, at any time; so what was checked for both is what moves.
//
//   ArmPair pair(scene, {"duo/left", "duo/right"}, tick);
//   pair.Follow(path, 1.0, 0.5);      // joint positions of both arms, those of the first one before
//   each tick: if (pair.Blocked()) ...; if (pair.Settled()) ...; pair.Next(); return pair.Command();
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "robocell/expert/guided_arm.h"
#include "robocell/robot/action.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

using PairPath = std::vector<std::vector<double>>;

// Returns the body that the last joint of the robot's arm moves, with the hand.
std::string LastLinkOf(const Robot& robot);

class ArmPair {
 public:
  // The names of two arms of one robot, for Robot::Of. Arms and grippers are at their targets.
  ArmPair(const Scene& scene, const std::array<std::string, 2>& arms, double tick);

  const Robot& arm(size_t i) const { return robots_[i]; }
  const std::array<Robot, 2>& arms() const { return robots_; }
  // Returns the targets of both arms in one vector, and splits such a vector.
  std::vector<double> target() const;
  JointVector Part(const std::vector<double>& both, size_t i) const;
  std::vector<double> Joined(const JointVector& first, const JointVector& second) const;
  std::string HandOf(size_t i) const { return LastLinkOf(robots_[i]); }

  // Moves both along a path from their targets, from rest to rest: the fastest joint has at most
  // `speed` on average (rad/s, m/s), and it lasts `least` seconds at least.
  void Follow(PairPath path, double speed, double least);
  // Slower where a held object would be shaken (GuidedArm::GentleSeconds), at most `most` seconds.
  void FollowGently(const PairPath& path, double speed, double least, double most);
  bool finished() const { return at_ >= ticks_; }
  // Returns true if the path has ended and both have come to rest. Call it once in a tick.
  bool Settled();
  bool Blocked();
  // Moves a gripper to an opening, 0 to 1, at a speed in 1/s from its present command.
  void SetOpening(size_t i, double opening, double speed);
  double opening(size_t i) const { return openings_[i]; }
  bool openings_reached() const { return openings_ == wanted_; }
  // Goes on by one tick.
  void Next();
  Action Command() const;
  int Ticks(double seconds) const { return guided_[0].Ticks(seconds); }

 private:
  std::array<Robot, 2> robots_;
  double tick_;
  std::array<GuidedArm, 2> guided_;
  PairPath path_;
  std::vector<double> lengths_;  // of the path up to each of its points
  int ticks_ = 0, at_ = 0;
  std::array<double, 2> openings_ = {1, 1}, wanted_ = {1, 1}, steps_ = {1, 1};
};

}  // namespace robocell::internal
