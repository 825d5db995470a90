// The checks that warn, at every compile, of values of a robot that the engine accepts and nobody
// intends (degrees for radians, millimetres for metres). A new one is a file with a function and a
// line here. Trials of a live robot are in diagnose/trials.h.
#pragma once

#include <mujoco/mujoco.h>

#include <string>

#include "robocell/scene/compile_log.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/inspection/findings.h"
#include "robocell/scene/part.h"

// Checks of a robot's compiled model. They allocate little and step nothing. Each is in the file of
// the same name (CheckFingers in fingers.cc). The scale comes first: in a robot in millimetres it
// causes the findings of the others.
#define ROBOCELL_MODEL_CHECKS(CHECK) \
  CHECK(CheckScale)                  \
  CHECK(CheckFingers)                \
  CHECK(CheckRanges)                 \
  CHECK(CheckServos)                 \
  CHECK(CheckTendons)                \
  CHECK(CheckInertia)                \
  CHECK(CheckCameraPlaces)           \
  CHECK(CheckPedestals)

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

using ModelCheck = void(const CompiledRobot&, Findings&);
#define ROBOCELL_DECLARE(function) ModelCheck function;
ROBOCELL_MODEL_CHECKS(ROBOCELL_DECLARE)
#undef ROBOCELL_DECLARE

// Adds the findings of all checks, in their order, to the log as warnings and notes, and no
// problems.
void InspectRobot(const CompiledRobot& robot, CompileLog& log);

}  // namespace robocell::internal
