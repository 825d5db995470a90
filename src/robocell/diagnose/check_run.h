// All that can be said of a run before its first episode: what refuses it (rollout/validate_run.h),
// then what works and is probably not meant. `robocell generate` shows it.
//
//   for (const std::string& warning : CheckRun(RunConfig::Load("pick.yaml"))) ...
#pragma once

#include <string>
#include <vector>

#include "robocell/rollout/validate_run.h"

namespace robocell {

// The errors of ValidateRun. Returns warnings: those of compiling the scene, of the task and its
// expert; for runs of the scripted expert, what its robot does not do as it is told
// (check_robot.h); images that are too small to show anything. Writes nothing.
std::vector<std::string> CheckRun(const RunConfig& run, const RunDemands& demands = {});

}  // namespace robocell
