// Checks everything about a run before its first episode: problems that reject it
// (rollout/validate_run.h), then valid settings that are probably unintended. `robocell generate`
// shows it.
//
//   for (const Finding& warning : CheckRun(RunConfig::Load("pick.yaml"))) LogWarn(Line(warning));
#pragma once

#include <vector>

#include "robocell/rollout/validate_run.h"
#include "robocell/scene/inspection/finding.h"

namespace robocell {

// Throws the errors of ValidateRun. Returns warnings: those of compiling the scene, of the task and
// its expert; for runs of the scripted expert, commands that its robot does not follow
// (check_robot.h); images that are too small to show anything. Writes nothing.
std::vector<Finding> CheckRun(const RunConfig& run, const RunDemands& demands = {});

}  // namespace robocell
