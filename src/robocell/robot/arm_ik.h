// Options of inverse kinematics for a robot's arm.
//
//   const IkBatchResult all = IkBatch(robot.chain(), targets, {}, {.ik = ForArm(robot, {})});
#pragma once

#include "robocell/kinematics/ik.h"
#include "robocell/robot/robot.h"

namespace robocell {

// Returns the options with what counts of a pose for the arm: its `task_space` in the robot file, as
// Robot::Ik does. Options that choose a part themselves (position_only, axis, weights other than 1)
// are returned as they are. Throws NotFoundError for a robot without an arm.
IkOptions ForArm(const Robot& robot, IkOptions options);

}  // namespace robocell
