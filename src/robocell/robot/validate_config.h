// What a robot's file says although its model does otherwise: valid by itself, and found by trying
// the robot in a copy of the simulation. Asked by `robocell check` and before every run.
//
//   Problems problems(config.locations);
//   ValidateConfig(robot, problems);            // move_groups.gripper.distance, base.size
//   problems.Throw("robot 'rc7'");
#pragma once

#include "robocell/robot/robot.h"
#include "robocell/spec/problems.h"

namespace robocell::internal {

// Adds the problems at the paths of the configuration's fields. The robot's scene does not change.
// Takes up to a second per gripper.
void ValidateConfig(const Robot& robot, Problems& problems);

// Adds each gripper whose `distance` is not what its fingers do. Grippers that cannot be measured
// are left alone: what the file says is all that is known.
void ValidateDistances(const Robot& robot, Problems& problems);

// Adds each arm and gripper that no controller can drive: motors, where a run sends joint positions
// and openings. False when there is one.
bool ValidateControllers(const Robot& robot, Problems& problems);

// Adds the first arm when its controller takes something else than joint positions, which the
// scripted expert sends. Other experts may command other things. Arms have controllers.
void ValidateTakesJointPositions(const Robot& robot, Problems& problems);

}  // namespace robocell::internal
