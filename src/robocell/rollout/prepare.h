// The folder of a run's dataset: created with its manifest before the first episode, and recognised
// when the run continues.
#pragma once

#include "robocell/rollout/run_inputs.h"

namespace robocell {

// Creates the dataset's folder with its manifest, or checks that the existing folder belongs to the
// same run. Throws SpecError that names each difference if the inputs (run_inputs.h) differ, and
// SpecError for a folder with foreign entries.
// A lost dataset.json is written again if the episodes agree. A dataset without episodes is
// restarted if the inputs changed. Models that episodes were made with and that are missing are
// copied into the dataset again. The run is validated first (validate_run.h, without the scripted
// expert's requirements), so that a mistake leaves nothing behind. Callers that have validated it
// already, perhaps in a process of their own because models may crash the engine, leave this out.
// Throws IoError if the folder cannot be written, or another process is generating into it. Any
// number of processes may call it for the same run.
struct PrepareOptions {
  bool validate = true;
};
void PrepareDataset(const RunConfig& run, const PrepareOptions& options = {});

// Checks the folder like PrepareDataset, but writes nothing.
void ValidateDataset(const RunConfig& run);

// Returns the source files of the run's task and features that have changed since the dataset was
// begun; empty for a dataset without a manifest.
std::vector<std::string> ChangedCode(const std::string& dataset, const RunConfig& run);

// Returns the present inputs of the run. Throws SpecError unless the dataset was prepared for this
// run. Writes nothing.
RunInputs RequireSameRun(const RunConfig& run);

}  // namespace robocell
