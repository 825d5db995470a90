// Checks a robot's file against its model: settings that are valid by themselves, tried with the
// robot in a copy of the simulation. `robocell check` and every run call it.
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

// Adds each gripper whose `distance` differs from that of its fingers. Grippers that cannot be
// measured are skipped: the file is the only source.
void ValidateDistances(const Robot& robot, Problems& problems);

// Adds each arm and gripper that no controller can drive: motors, where a run sends joint positions
// and openings. Returns false if there is one.
bool ValidateControllers(const Robot& robot, Problems& problems);

// Adds the first arm if its controller does not take joint positions, which the scripted expert
// sends. Other experts may send other commands. Arms have controllers.
void ValidateTakesJointPositions(const Robot& robot, Problems& problems);

}  // namespace robocell::internal
