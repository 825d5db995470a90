// Turns paths of an object in the hand into joint motions: inserting a peg, wiping with a sponge and
// pouring are such motions.
//
//   HeldMotions motions(planning, object_in_tcp, paths, q, {.gap = width});
//   while (std::optional<HeldMotion> motion = motions.Next()) ...
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robocell/kinematics/joint_vector.h"
#include "robocell/math/pose.h"
#include "robocell/motion/joint_path.h"
#include "robocell/motion/planning_scene.h"

namespace robocell::internal {

// Poses of a held object in the world, in fine steps, free of contacts: where it is to press on
// something, the path keeps a little above that.
using HeldPath = std::vector<Pose>;

struct HeldMotion {
  size_t path = 0;  // its index
  JointPath along;  // one configuration for each pose
};

struct HeldMotionOptions {
  double gap = 0;  // gap between the fingers while they hold the object, m
};

class HeldMotions {
 public:
  // `planning` is modified and must outlive this object. `start`: joint positions that solutions
  // should be near.
  HeldMotions(PlanningScene& planning, const Pose& object_in_tcp, std::vector<HeldPath> paths,
              const JointVector& start, const HeldMotionOptions& options);

  // Returns the next motion, in the order of the paths; unset when none is left.
  std::optional<HeldMotion> Next();
  // Returns why paths so far were rejected: "of 16 ways 12 out of reach, 3 in collision".
  std::string Reasons() const;

 private:
  std::optional<HeldMotion> Try(size_t path, const JointVector& q);

  PlanningScene& planning_;
  Pose tcp_in_object_, world_in_base_;
  std::vector<HeldPath> paths_;
  HeldMotionOptions options_;
  struct Start {
    size_t path;
    JointVector q;
  };
  std::vector<Start> starts_;
  size_t next_ = 0;
  int out_of_reach_ = 0, no_way_ = 0, in_collision_ = 0;
  ObstacleCounts obstacles_;
};

// Adds poses on the straight way to a pose to a path: steps of at most 5 mm and 0.05 rad.
void AppendStraight(HeldPath& path, const Pose& to);

}  // namespace robocell::internal
