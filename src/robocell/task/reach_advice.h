// Finds where the base of a robot has to stand for grasps from above, and advises on it when a run's
// sampler refused every start.
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/run_config.h"

namespace robocell::internal {

// Returns "base_distance and base_height_offset from which a grasp is in reach ...". It solves
// inverse kinematics for grasps from above at distances and heights all around the robot, with the
// pregrasp and the lift of a pick; collisions are not checked. Takes about a second. Throws what
// building a scene with the robot throws.
std::string ReachAdvice(const RunConfig& run);

// Distances of the base from the object, m, at a height offset of the base (StartConfig) from which
// a grasp from above is in reach, with the pregrasp and the lift of the run's task.
struct GraspReach {
  double height_offset = 0, nearest = 0, farthest = 0;
};

// Returns the distances at the run's own height offset, or else at the one with the most of them;
// unset if there is none. Costs and throws like ReachAdvice.
std::optional<GraspReach> FindGraspReach(const RunConfig& run);

}  // namespace robocell::internal
