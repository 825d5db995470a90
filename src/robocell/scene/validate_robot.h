// Private to scene: checks that the compiled model has everything that a robot's configuration
// names, and that it fits. Problems go to the log. Advice belongs to diagnose.
#pragma once

#include <mujoco/mujoco.h>

#include <vector>

#include "robocell/mujoco/owners.h"
#include "robocell/scene/compile_log.h"
#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Returns data with the joints at their reference and the resulting poses, tendons and actuator
// moments.
DataPtr AtReference(const mjModel* model);

void ValidateRobot(const mjModel* model, const RobotRecord& robot, CompileLog& log);

// validate_groups.cc: checks that an arm's joints are those from the root to its leaf, in order,
// and that a gripper's actuators do not move the whole hand. Skips missing elements, which
// ValidateRobot reports. `reference` is AtReference.
void ValidateGroups(const mjModel* model, const mjData* reference,
                    const std::vector<RobotRecord>& robots, CompileLog& log);

// validate_tool_points.cc: checks that a TCP given twice, as the leaf of the arm and as
// attachment_site * tcp_offset, is the same.
void ValidateToolPoints(const mjModel* model, const mjData* reference,
                        const std::vector<RobotRecord>& robots, CompileLog& log);

}  // namespace robocell::internal
