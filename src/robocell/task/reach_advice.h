// Advises where to place a robot that reaches nothing. Used when a run's sampler refused every
// start, and to place robots that were just brought in.
#pragma once

#include "robocell/spec/run_config.h"
#include "robocell/task/task_kind.h"

namespace robocell::internal {

// Returns from which heights and distances of the base a grasp is in reach. It solves
// inverse kinematics for grasps from above at distances and heights all around the robot, with the
// pregrasp and the lift of a pick; collisions are not checked. Takes about a second. Throws what
// building a scene with the robot throws.
ReachAdvice AdviseReach(const RunConfig& run);

}  // namespace robocell::internal
