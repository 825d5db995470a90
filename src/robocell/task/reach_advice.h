// Advises where to place a robot that reaches nothing. Used when a run's sampler refused every
// start.
#pragma once

#include <string>

#include "robocell/spec/run_config.h"

namespace robocell::internal {

// Returns "base_distance and base_height_offset from which a grasp is in reach ...". It solves
// inverse kinematics for grasps from above at distances and heights all around the robot, with the
// pregrasp and the lift of a pick; collisions are not checked. Takes about a second. Throws what
// building a scene with the robot throws.
std::string ReachAdvice(const RunConfig& run);

}  // namespace robocell::internal
