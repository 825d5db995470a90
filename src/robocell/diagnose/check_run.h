// Checks everything about a run before its first episode: problems that reject it
// (rollout/validate_run.h), then valid settings that are probably unintended. `robocell generate`
// shows it.
//
//   for (const std::string& warning : CheckRun(RunConfig::Load("pick.yaml"))) ...
#pragma once

#include <string>
#include <vector>

#include "robocell/rollout/validate_run.h"

namespace robocell {

// Throws the errors of ValidateRun. Returns warnings: those of compiling the scene, of the task and
// its expert; for runs of the scripted expert, commands that its robot does not follow
// (check_robot.h); images that are too small to show anything. Writes nothing.
std::vector<std::string> CheckRun(const RunConfig& run, const RunDemands& demands = {});

}  // namespace robocell
