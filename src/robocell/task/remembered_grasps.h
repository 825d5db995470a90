// Generated grasps for picks, in which registered libraries and cached files play no part: episodes
// of a seed are the same in every process.
#pragma once

#include <string>

#include "robocell/robot/robot.h"
#include "robocell/task/grasp.h"
#include "robocell/task/grasp_generator.h"

namespace robocell::internal {

// Like GenerateGrasps; the process remembers the latest ones by the geometry of hand and object.
GraspSet RememberedGrasps(const Robot& robot, const std::string& body,
                          const GraspOptions& options = {});

}  // namespace robocell::internal
