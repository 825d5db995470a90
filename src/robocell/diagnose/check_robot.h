// Tries a robot out: what touches at home, whether TCPs are at grippers, whether its arms, with the
// controllers that runs use, stay there and follow a small step of each joint, and which actuators
// no group has. What a file and its model say can be right and the servos still be too weak, too
// slow or blocked. `robocell check` shows these findings, and `generate` before every run.
//
//   for (const Finding& finding : CheckRobot(robot)) std::puts(Line(finding).c_str());
//   // "arm.yaml:9:14: robot 'arm': force_limit: joint 'hip' drifts by 0.4 rad in 1 s while it
//   //  should hold home ...: its servo 'drive' pushes with all it may, 2 N m, and gravity ..."
//
// Values of its model that are probably not meant are warnings of every compile
// (CompiledScene::warnings). What makes a robot unusable is not advice: rollout/validate_run.h.
#pragma once

#include <vector>

#include "robocell/diagnose/finding.h"
#include "robocell/robot/robot.h"

namespace robocell {

struct RobotCheckOptions {
  // Leaves out what the warnings of the robot's scene say already: an arm's servo whose ctrlrange
  // ends before home (servos.cc).
  bool beside_warnings = false;
  // For a run, whose task says which arms it uses: nothing is said of the first arm.
  bool for_run = false;
};

// One finding for each pair that touches, and for each arm and reason; arms without a controller are
// passed over. The robot's scene is reset and stepped, a few seconds for each joint that does not
// follow and less for the others. Errors: those of stepping the scene.
std::vector<Finding> CheckRobot(Robot robot, const RobotCheckOptions& options = {});

}  // namespace robocell
