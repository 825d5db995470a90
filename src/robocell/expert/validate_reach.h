// Whether the places that a pick run proposes for the robot's base can be in its reach at all.
#pragma once

#include "robocell/robot/robot.h"
#include "robocell/spec/pick_task_config.h"
#include "robocell/spec/problems.h"
#include "robocell/task/base_placement.h"

namespace robocell {

// Adds problems of start.base_distance, start.base_height_offset and task.lift_height for places
// and lifts that PickTaskSampler refuses in every start.
void ValidateReach(const PickRun& task, const BaseRange& base, const Robot& robot,
                   Problems& problems);

}  // namespace robocell
