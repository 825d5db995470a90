// Everything about a run that can be known to be wrong before its first episode: fields, streams
// that cannot be recorded, object kinds, and, with robot and scene compiled once, models, cameras,
// columns, a robot file that its model contradicts, what the scripted expert needs of the robot,
// and whether this machine can draw and encode the streams.
//
//   CheckRun(RunConfig::Load("pick.yaml"));   // SpecError: all problems with file:line:column
#pragma once

#include <string>
#include <vector>

#include "robocell/spec/run_config.h"

namespace robocell {

struct RunDemands {
  bool scripted_expert = true;  // false: the caller brings an expert, which knows what it needs
  bool on_this_machine = true;  // false: the episodes are made elsewhere
};

// Raises SpecError with all problems, and IoError or Error if streams are recorded and this machine
// lacks an encoder or OpenGL. Returns warnings, that is, configurations that are valid but probably
// unintended: warnings of compiling the scene, an arm that does not follow its commands
// (robot_trial.h), images that are too small to show anything. Writes nothing.
std::vector<std::string> CheckRun(const RunConfig& run, const RunDemands& demands = {});

// The part that needs no model.
void CheckRunFields(const RunConfig& run);

}  // namespace robocell
