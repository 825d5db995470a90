// The arms that do the task of a run or of an environment, as names for Robot::Of (acting_arms.h).
#pragma once

#include <string>
#include <vector>

#include "robocell/scene/scene.h"
#include "robocell/spec/run_config.h"

namespace robocell::internal {

// Returns the arms of these robots that have a gripper; all of them if none has.
std::vector<std::string> ArmsWithHands(const Scene& scene, const std::vector<std::string>& robots);

// Returns the arm that the run names, else ArmsWithHands of its robot.
std::vector<std::string> ArmsOfRun(const RunConfig& run, const Scene& scene);

// Returns the name of the arm that the run names, else of the first one.
std::string FirstArmOfRun(const RunConfig& run);

}  // namespace robocell::internal
