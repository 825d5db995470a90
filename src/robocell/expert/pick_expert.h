// The kinds of experts `pick` and `pick_and_place` (expert_kind.h): the planners, and their
// requirements on a robot.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/expert/expert_kind.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/problems.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/pick_task_config.h"

namespace robocell::internal {

std::shared_ptr<const ExpertKind> MakePickExpert();
std::shared_ptr<const ExpertKind> MakePickAndPlaceExpert();

// Adds the expert's requirements that a robot which passed ValidateRobot does not satisfy: a base
// that can be placed with the objects in reach, an arm that takes joint positions, a gripper with
// fingers. `options` and `timestep` are the run's. Returns false if it added a problem.
bool ValidatePickRobot(const Robot& robot, const SimOptions& options, double timestep,
                       Problems& problems);

// Adds a problem of task.lift_height for a lift that no arm in this range of its base can make, so
// that StartSampler refuses every start.
void ValidateLift(double lift_height, const BaseRange& base, const Robot& robot,
                  Problems& problems);

}  // namespace robocell::internal
