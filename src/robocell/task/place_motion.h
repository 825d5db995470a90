// Turns poses at which an object is to be put down into joint motions: how the arm gets there from
// above with the object in its hand, and leaves with the hand open.
//
//   PlaceMotions motions(planning, object_in_tcp, PosesAbout(goal, object_in_world), q);
//   while (std::optional<PlaceMotion> motion = motions.Next()) ...
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/kinematics/joint_vector.h"
#include "robocell/motion/joint_path.h"
#include "robocell/motion/planning_scene.h"

namespace robocell {

struct PlaceMotion {
  Pose object_in_world;  // object pose at the release
  JointPath down;        // above the place ... at the place; the way back is the same
};

struct PlaceMotionOptions {
  double above = 0.10;   // height at which the descent begins, metres
  double gap = 0;        // gap between the fingers while they hold the object, metres
  double clearance = 0;  // clearance of hand and object at that height, metres
};

// Returns where to release an object that is to rest at `place`: just high enough above it that
// nothing touches yet.
Eigen::Vector3d PlaceOver(const Eigen::Vector3d& place);
// Returns the poses of an object whose origin is at `place` (world), turned about the vertical in
// equal steps from its rotation in `object_in_world`.
std::vector<Pose> PosesAbout(const Eigen::Vector3d& place, const Pose& object_in_world);

class PlaceMotions {
 public:
  // `planning` is modified, including the pose of its target, and must outlive this object.
  // `poses`: of the object, in the world. `start`: joint positions that solutions should be near.
  PlaceMotions(PlanningScene& planning, const Pose& object_in_tcp, const std::vector<Pose>& poses,
               const JointVector& start, const PlaceMotionOptions& options = {});

  // Returns the next motion, nearest to the start first; unset when none is left.
  std::optional<PlaceMotion> Next();
  // Returns why the motions so far were rejected: "of 16 ways to put it down 12 out of reach, 4 in
  // collision".
  std::string Reasons() const;

 private:
  struct Candidate {
    Pose object_in_world, tcp_in_base;
    JointVector q;
  };
  bool IsFree(const Candidate& candidate, const JointPath& down);

  PlanningScene& planning_;
  Pose object_in_tcp_;
  PlaceMotionOptions options_;
  std::vector<Candidate> candidates_;
  size_t next_ = 0;
  int count_ = 0, out_of_reach_ = 0, no_way_down_ = 0, in_collision_ = 0;
  ObstacleCounts obstacles_;
};

}  // namespace robocell
