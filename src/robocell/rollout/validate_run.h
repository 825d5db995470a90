// Checks everything about a run that can be known to be wrong before its first episode: fields,
// streams that cannot be recorded, object kinds, and, with robot and scene compiled once, models,
// cameras, columns, a robot file that its model contradicts, the scripted expert's requirements on
// the robot, and whether this machine can draw and encode the streams.
//
//   ValidateRun(RunConfig::Load("pick.yaml"));   // SpecError: all problems with file:line:column
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/inspection/finding.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/run_config.h"

namespace robocell {

struct RunDemands {
  bool scripted_expert = true;  // false: the caller brings an expert, which checks its own needs
  bool on_this_machine = true;  // false: the episodes are made elsewhere
  bool output = true;           // false: nothing is recorded, so that `output` may be empty
};

// Throws SpecError with all problems, and IoError or Error if streams are recorded and this machine
// lacks an encoder or OpenGL. Returns warnings: those of compiling the scene, and those of the task
// and of its expert, whose subject is a field of the run. Writes nothing. More advice:
// diagnose/check_run.h.
std::vector<Finding> ValidateRun(const RunConfig& run, const RunDemands& demands = {});

// Checks the part that needs no model.
void ValidateRunFields(const RunConfig& run, const RunDemands& demands = {});

// The requirements on a robot and its file that everything shares: `robocell check`,
// `validate_robot` in Python, and every run. A robot that one of them rejects is rejected by all.
//
//   Problems problems(robot.config().locations);
//   ValidateRobot(robot, problems);
//   problems.Throw("robot 'rc7'");
//
// Adds the problems at the paths of the configuration's fields: arms and grippers without a
// controller, names that no record can have, a file that its model contradicts (validate_config.h).
// Returns false if it added one. Does not change the robot's scene.
bool ValidateRobot(const Robot& robot, Problems& problems);

}  // namespace robocell
