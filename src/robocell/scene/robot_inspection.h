// Private to scene: a hook for checks that warn, at every compile, of values of a robot that the
// engine accepts and nobody intends (degrees for radians, millimetres for metres). Those checks are
// advice, so they live in diagnose/; nothing in scene includes them, they install themselves.
#pragma once

#include <mujoco/mujoco.h>

#include "robocell/scene/compile_log.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/part.h"

namespace robocell::internal {

// One robot of a model that has just been compiled; valid during the inspection.
struct CompiledRobot {
  const mjModel* model = nullptr;
  // Joints at their reference, with the resulting poses, tendons and actuator moments.
  const mjData* reference = nullptr;
  int home_key = -1;
  const RobotRecord& robot;
  const Part& part;  // the robot's own model, with its files and lines

  // Returns the beginning of warnings about it: "robot 'left'".
  std::string place() const { return "robot '" + robot.name + "'"; }
};

// Adds warnings and notes to the log, and no problems.
using RobotInspection = void (*)(const CompiledRobot&, CompileLog&);

// Applies to all scenes compiled from now on. Returns true, so that a static variable can install
// it.
bool InstallRobotInspection(RobotInspection inspection);

RobotInspection InstalledRobotInspection();

// Calls the installed inspection.
void InspectRobot(const CompiledRobot& robot, CompileLog& log);

}  // namespace robocell::internal
