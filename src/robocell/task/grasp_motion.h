// From grasp candidates to joint motions: which of them the arm can reach from straight above and
// leave straight up, without touching anything it should not.
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
  double above = 0.08;  // of the pregrasp, metres
  double lift = 0.10;   // metres
  int most = 60;        // candidates looked at
};
// For a task that asks for a lift of `height` metres: a little more, since objects slip.
GraspMotionOptions GraspMotionsToLift(double height);

class GraspMotions {
 public:
  // `home`: joint positions that solutions should be near. The planning scene is used, and must
  // live as long.
  GraspMotions(PlanningScene& planning, std::vector<GraspCandidate> candidates,
               const JointVector& home, const GraspMotionOptions& options = {});

  // The next best one; unset when there is none left.
  std::optional<GraspMotion> Next();
  // Why the candidates so far were no good: "of 15 grasps 12 out of reach (the nearest by 0.08 m),
  // 3 in collision".
  std::string Reasons() const;
  // Returns true if most of those that were no good collide; else most are out of reach.
  bool MostCollide() const;

 private:
  void SolveMore();
  std::optional<GraspMotion> TryCandidate(const GraspCandidate& grasp, const JointVector& q);
  // IsFree of the planning scene; what is in the way is counted.
  bool IsFree(const JointVector& q, const FreedomDemand& demand);

  PlanningScene& planning_;
  std::vector<GraspCandidate> candidates_;
  JointVector home_;
  GraspMotionOptions options_;
  Pose world_in_base_;
  Eigen::Vector3d up_in_base_;
  size_t next_ = 0;
  std::vector<JointVector> solved_;  // of the first candidates; empty: none
  std::vector<double> missed_by_;    // of the same, metres
  // How many candidates failed at what, and by how much at least, metres.
  struct Misses {
    int count = 0;
    double least = std::numeric_limits<double>::infinity();
    void Add(double amount) { ++count, least = std::min(least, amount); }
  };
  Misses out_of_reach_, no_way_down_, no_way_up_;
  int in_collision_ = 0;
  InTheWay in_the_way_;
};

}  // namespace robocell
