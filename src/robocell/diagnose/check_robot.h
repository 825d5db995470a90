// Tries a robot: contacts at home, TCPs at grippers, whether its arms, with the controllers that
// runs use, stay at home and follow a small step of each joint, and actuators without a group. A
// file and its model can be correct and the servos still be too weak, too slow or blocked.
// `robocell check` shows these findings, and so does `generate` before every run.
//
//   for (const Finding& finding : CheckRobot(robot)) std::puts(Line(finding).c_str());
//   // "arm.yaml:9:14: robot 'arm': force_limit: joint 'hip' drifts by 0.4 rad in 1 s while it
//   //  should hold home ...: its servo 'drive' pushes with all it may, 2 N m, and gravity ..."
//
// Values of its model that are probably unintended are warnings of every compile
// (CompiledScene::warnings). Problems that make a robot unusable are not advice:
// rollout/validate_run.h.
#pragma once

#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/inspection/finding.h"

namespace robocell {

struct RobotCheckOptions {
  // Leaves out findings that the warnings of the robot's scene already contain: an arm's servo
  // whose ctrlrange ends before home (servos.cc).
  bool beside_warnings = false;
  // Omits findings about the first arm; for runs, whose task selects the arms.
  bool for_run = false;
};

// Returns one finding for each touching pair, and for each arm and reason; arms without a
// controller are skipped. The robot's scene is reset and stepped, a few seconds for each joint that
// does not follow and less for the others. Throws the errors of stepping the scene.
std::vector<Finding> CheckRobot(Robot robot, const RobotCheckOptions& options = {});

}  // namespace robocell
