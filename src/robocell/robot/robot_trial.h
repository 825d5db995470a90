// Tries a robot out: what touches at home, whether TCPs are at grippers, whether its arms, with the
// controllers that runs use, stay there and follow a small step of each joint, and which actuators
// no group has. What a file and its model say can be right and the servos still be too weak, too
// slow or blocked. Asked by `robocell check` and before every run.
//
//   for (const std::string& doubt : TryRobot(robot)) ...
//   // "arm.yaml:9:14: force_limit: joint 'hip' drifts by 0.4 rad in 1 s while it should hold home
//   //  ...: its servo 'drive' pushes with all it may, 2 N m, and gravity asks for 5. Raise ..."
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"

namespace robocell {

// One text for each pair that touches, and for each arm and reason, with file:line:column where the
// robot's file has them; arms without a controller are passed over. The scene is reset and stepped,
// a few seconds for each joint that does not follow and less for the others.
std::vector<std::string> TryRobot(Robot robot);

// The same for callers that also report the warnings of the robot's scene: without servos of arms
// whose ctrlrange ends before home, which the scene reports (scene/check_servos.cc).
std::vector<std::string> TryRobotBesideWarnings(Robot robot);

}  // namespace robocell
