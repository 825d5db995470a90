// Whether the places that a pick run proposes for the robot's base can be in its reach at all.
#pragma once

#include "robocell/robot/robot.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/run_config.h"

namespace robocell {

// Adds problems of task.base_distance and task.base_height_offset for distances from which
// PickTaskSampler refuses every start.
void CheckReach(const RunConfig& run, const Robot& robot, Problems& problems);

}  // namespace robocell
