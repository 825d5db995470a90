// Everything about a run that can be known to be wrong before its first episode: fields, streams
// that cannot be recorded, object kinds, and, with robot and scene compiled once, models, cameras,
// columns, a robot file that its model contradicts, what the scripted expert needs of the robot,
// and whether this machine can draw and encode the streams.
//
//   ValidateRun(RunConfig::Load("pick.yaml"));   // SpecError: all problems with file:line:column
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/run_config.h"

namespace robocell {

struct RunDemands {
  bool scripted_expert = true;  // false: the caller brings an expert, which knows what it needs
  bool on_this_machine = true;  // false: the episodes are made elsewhere
};

// SpecError with all problems; IoError or Error when this machine lacks an encoder or OpenGL and
// streams are recorded. Returns the warnings on the way: those of compiling the scene, of the task
// and its expert. Writes nothing. More advice: diagnose/check_run.h.
std::vector<std::string> ValidateRun(const RunConfig& run, const RunDemands& demands = {});

// The part that needs no model.
void ValidateRunFields(const RunConfig& run);

// What a robot and its file need for everything that uses one: `robocell check`,
// `validate_robot` in Python, and every run. What one of them refuses, the others refuse too.
//
//   Problems problems(robot.config().locations);
//   ValidateRobot(robot, problems);
//   problems.Throw("robot 'rc7'");
//
// Adds what is wrong, at the paths of the configuration's fields: arms and grippers without a
// controller, names that no record can have, a file that its model contradicts (validate_config.h).
// False when there is something. The robot's scene is not changed.
bool ValidateRobot(const Robot& robot, Problems& problems);

}  // namespace robocell
