// Whether the places that a pick run proposes for the robot's base can be in its reach at all.
#pragma once

#include "robocell/robot/robot.h"
#include "robocell/spec/pick_task_config.h"
#include "robocell/spec/problems.h"

namespace robocell {

// Adds problems of task.base_distance, task.base_height_offset and task.lift_height for places and
// lifts that PickTaskSampler refuses in every start.
void ValidateReach(const PickRun& task, const Robot& robot, Problems& problems);

}  // namespace robocell
