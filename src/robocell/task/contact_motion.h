// Turns paths of the hand in contact with something into joint motions: the hand comes on a straight
// line, follows the path, and leaves on a straight line. Opening a door, pressing a button and
// pushing an object are such motions.
//
//   ContactMotions motions(planning, paths, home);
//   while (std::optional<ContactMotion> motion = motions.Next()) ...
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "robocell/kinematics/joint_vector.h"
#include "robocell/motion/joint_path.h"
#include "robocell/motion/planning_scene.h"

namespace robocell {

struct ContactPath {
  std::vector<Pose> tcp_in_world;                   // from the contact to the end, in fine steps
  Eigen::Vector3d from = Eigen::Vector3d::UnitZ();  // in the world: from the contact to before it
  Eigen::Vector3d away = Eigen::Vector3d::UnitZ();  // in the world: from the end to after it
  double before = 0.08, after = 0.08;               // lengths of these lines, m
  double free_gap = 0;                              // distance of the fingers on the lines, m
  double contact_gap = 0;                           // ... on the path
  bool grips = true;  // false: moves by pushing, and a hand that grips does not close
  size_t closed_at =
      0;  // the pose at which the fingers have closed; the hand moves there meanwhile
};

// Returns the distance of the fingers of a hand that pushes or presses as one: nearly closed, so that
// the fingers do not touch each other.
double GapOfClosedHand(const GripperShape& shape);

struct ContactMotion {
  size_t path = 0;   // its index
  JointPath in;      // before ... at the contact
  JointPath along;   // at the contact ... at the end
  JointPath out;     // at the end ... after it, as far as that is free; at least half of it
  double share = 1;  // of the path that the arm can follow
};

// Returns further paths at each call, the best first; empty: there are none any more. Paths that take
// time to compute come later, and are computed only if those before have no motion.
using ContactPathSource = std::function<std::vector<ContactPath>()>;
// Returns the source of these paths.
ContactPathSource SourceOf(std::vector<ContactPath> paths);
// Returns all paths of a source.
std::vector<ContactPath> AllPathsOf(const ContactPathSource& source);

struct ContactMotionOptions {
  // Motions that follow less than this share of their path are rejected. Those that follow all of it
  // come first. Below 1, a motion ends earlier where the hand has no way out from the end.
  double least_share = 1;
  // Is called when no path so far can be followed as a whole.
  ContactPathSource more = {};
};

class ContactMotions {
 public:
  // `planning` is modified and must outlive this object. The hand may touch its target, except on
  // the line to the contact. `home`: joint positions that solutions should be near.
  ContactMotions(PlanningScene& planning, std::vector<ContactPath> paths, const JointVector& home,
                 const ContactMotionOptions& options = {});

  // Returns the next best motion; unset when none is left.
  std::optional<ContactMotion> Next();
  // Returns why paths so far were rejected: "of 30 ways 12 out of reach, 3 in collision".
  std::string Reasons() const;
  // Returns the paths so far; ContactMotion::path is an index into these.
  const std::vector<ContactPath>& paths() const { return paths_; }

 private:
  struct Start {
    size_t path;
    JointVector q;
  };
  void SolveMore();
  bool AddMore();
  std::optional<ContactMotion> Try(const Start& start);
  JointPath WayOut(const ContactPath& path, const JointPath& along);

  PlanningScene& planning_;
  std::vector<ContactPath> paths_;
  ContactMotionOptions options_;
  JointVector home_;
  Pose world_in_base_;
  size_t solved_ = 0;  // paths whose start has been solved
  std::vector<Start> starts_;
  size_t next_ = 0;
  std::vector<ContactMotion> partial_;  // those that follow a part of their path, best last
  int out_of_reach_ = 0, no_line_ = 0, no_way_ = 0, no_way_out_ = 0, in_collision_ = 0;
  ObstacleCounts obstacles_;
};

}  // namespace robocell
