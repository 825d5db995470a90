// Everything about a run that can be known to be wrong before its first episode: fields, streams
// that cannot be recorded, object kinds, and, with robot and scene compiled once, models, cameras,
// columns, and what the scripted expert needs of the robot.
//
//   CheckRun(RunConfig::Load("pick.yaml"));   // SpecError: all problems with file:line:column
#pragma once

#include "robocell/spec/run_config.h"

namespace robocell {

struct RunDemands {
  bool scripted_expert = true;  // false: the caller brings an expert, which knows what it needs
};

// SpecError with all problems. Writes nothing.
void CheckRun(const RunConfig& run, const RunDemands& demands = {});

// The part that needs no model.
void CheckRunFields(const RunConfig& run);

}  // namespace robocell
