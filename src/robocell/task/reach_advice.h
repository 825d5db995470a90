// Advice for a robot that reaches nothing: from where it would. Used when a run's sampler refused
// every start.
#pragma once

#include <string>

#include "robocell/spec/run_config.h"

namespace robocell::internal {

// "base_distance and base_height_offset from which a grasp is in reach ...", by inverse kinematics
// of grasps from above at distances and heights all around the robot, with the pregrasp and the
// lift of a pick; nothing is said of collisions. Takes about a second. The errors of a scene with
// the robot.
std::string ReachAdvice(const RunConfig& run);

}  // namespace robocell::internal
