// The kinds of experts `pick` and `pick_and_place` (expert_kind.h): the planners, and what they need
// of a robot.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/expert/expert_kind.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/pick_task_config.h"
#include "robocell/spec/problems.h"
#include "robocell/task/base_placement.h"

namespace robocell {

std::shared_ptr<const ExpertKind> MakePickExpert();
std::shared_ptr<const ExpertKind> MakePickAndPlaceExpert();

// Adds what the expert lacks, of a robot that passed ValidateRobot: a base that can be put where the
// objects are in reach, an arm that takes joint positions, a gripper with fingers. `options` and
// `timestep` are the run's. False when there is something.
bool ValidatePickRobot(const Robot& robot, const SimOptions& options, double timestep,
                       Problems& problems);

// That as texts, for a robot of which nobody has said what it is for. Empty when pick tasks can use
// it.
std::vector<std::string> WhyNoPicks(const Robot& robot);

// Whether the places that a pick run proposes for the robot's base can be in its reach at all: adds
// problems of start.base_distance, start.base_height_offset and task.lift_height for places
// and lifts that PickTaskSampler refuses in every start.
void ValidateReach(const PickRun& task, const BaseRange& base, const Robot& robot,
                   Problems& problems);

}  // namespace robocell
