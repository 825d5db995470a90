// Finds contradictions between a robot's file and its model: configurations that are valid by
// themselves, but fail in a copy of the simulation. `robocell check` and every run call it.
//
//   Problems problems(config.locations);
//   CheckConfig(robot, problems);            // move_groups.gripper.distance, base.size
//   problems.Throw("robot 'rc7'");
#pragma once

#include "robocell/robot/robot.h"
#include "robocell/spec/problems.h"

namespace robocell {

// Adds the problems at the paths of the configuration's fields. The robot's scene does not change.
// Takes up to a second per gripper.
void CheckConfig(const Robot& robot, Problems& problems);

// Adds each gripper whose `distance` is not what its fingers do. Grippers that cannot be measured
// are left alone: what the file says is all that is known.
void CheckDistances(const Robot& robot, Problems& problems);

// Adds each arm and gripper that no controller can drive: motors, where a run sends joint positions
// and openings. False when there is one.
bool CheckHaveControllers(const Robot& robot, Problems& problems);

// Adds a problem if the controller of the first arm does not take joint positions, which the
// scripted expert sends. Other experts may command something else. Arms have controllers.
void CheckTakesJointPositions(const Robot& robot, Problems& problems);

}  // namespace robocell
