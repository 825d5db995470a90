// Private to scene: whether everything that a robot's configuration names is in the compiled model,
// and fits. What is wrong becomes a problem of the log. Advice is diagnose's.
#pragma once

#include <mujoco/mujoco.h>

#include <vector>

#include "robocell/mujoco/owners.h"
#include "robocell/scene/compile_log.h"
#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// The joints at their reference, with the poses, tendons and actuator moments that follow from it.
DataPtr AtReference(const mjModel* model);

void ValidateRobot(const mjModel* model, const RobotRecord& robot, CompileLog& log);

// validate_groups.cc: an arm's joints are those from the root to its leaf, in this order; a
// gripper's actuators do not move the whole hand. What is missing is passed over: ValidateRobot
// says so. `reference` is AtReference.
void ValidateGroups(const mjModel* model, const mjData* reference,
                    const std::vector<RobotRecord>& robots, CompileLog& log);

// validate_tool_points.cc: a TCP given twice, as the leaf of the arm and as attachment_site *
// tcp_offset, must be the same.
void ValidateToolPoints(const mjModel* model, const mjData* reference,
                        const std::vector<RobotRecord>& robots, CompileLog& log);

}  // namespace robocell::internal
