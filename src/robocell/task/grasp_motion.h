// Turns grasp candidates into joint motions: selects those that the arm can reach straight along their
// approach, which is down for those from above, and leave straight up without touching anything that
// it should not.
//
//   GraspMotions motions(planning, candidates, home);
//   while (std::optional<GraspMotion> motion = motions.Next()) ...
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "robocell/kinematics/joint_vector.h"
#include "robocell/motion/joint_path.h"
#include "robocell/motion/planning_scene.h"
#include "robocell/task/grasp_candidates.h"

namespace robocell {

struct GraspMotion {
  GraspCandidate grasp;
  JointPath down;  // pregrasp ... grasp
  JointPath up;    // grasp ... lifted
};

struct GraspMotionOptions {
  double above = 0.08;  // distance of the pregrasp back along the approach, metres
  double lift = 0.10;   // metres
  int most = 60;        // candidates tried at most
};
// Returns options for a task that requires a lift of `height` metres: a little more, since objects
// slip.
GraspMotionOptions GraspMotionsToLift(double height);

class GraspMotions {
 public:
  // `home`: joint positions that solutions should be near. `planning` is modified and must outlive
  // this object.
  GraspMotions(PlanningScene& planning, std::vector<GraspCandidate> candidates,
               const JointVector& home, const GraspMotionOptions& options = {});

  // Returns the next best motion; unset when none is left.
  std::optional<GraspMotion> Next();
  // Returns why the candidates so far were rejected: "of 15 grasps 12 out of reach (the nearest by
  // 0.08 m), 3 in collision".
  std::string Reasons() const;
  // Returns true if most of the rejected candidates collide; else most are out of reach.
  bool MostCollide() const;

 private:
  void SolveMore();
  std::optional<GraspMotion> TryCandidate(const GraspCandidate& grasp, const JointVector& q);
  // Calls IsFree of the planning scene and counts the obstacles.
  bool IsFree(const JointVector& q, const FreedomDemand& demand);

  PlanningScene& planning_;
  std::vector<GraspCandidate> candidates_;
  JointVector home_;
  GraspMotionOptions options_;
  Pose world_in_base_;
  Eigen::Vector3d up_in_base_;
  size_t next_ = 0;
  std::vector<JointVector> solved_;  // solutions of the first candidates; empty: none
  std::vector<double> missed_by_;    // pose errors of the same candidates, metres
  // Number of failed candidates for one reason, and the smallest error, metres.
  struct Misses {
    int count = 0;
    double least = std::numeric_limits<double>::infinity();
    void Add(double amount) { ++count, least = std::min(least, amount); }
  };
  Misses out_of_reach_, no_way_down_, no_way_up_;
  int in_collision_ = 0;
  ObstacleCounts obstacles_;
};

}  // namespace robocell
