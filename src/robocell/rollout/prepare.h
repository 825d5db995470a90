// The folder of a run's dataset: made with its manifest before the first episode, recognised when
// the run goes on.
#pragma once

#include "robocell/rollout/run_inputs.h"

namespace robocell {

// Creates the dataset's folder with its manifest, or checks that the folder there belongs to the
// same run: other inputs (run_inputs.h) are a SpecError that names each difference, and so is a
// folder with other things in it. A lost dataset.json is written again when the episodes agree. The
// run is validated first (validate_run.h, without the scripted expert's demands), so that a mistake
// leaves nothing behind; callers that have done so, in a process of their own perhaps because
// models may crash the engine, leave it out. A dataset without episodes is begun anew when the
// inputs changed. Models that episodes there were made in and that are missing are copied into the
// dataset again. IoError when the folder cannot be written, or somebody is generating into it. Any
// number of processes may call it for the same run.
struct PrepareOptions {
  bool validate = true;
};
void PrepareDataset(const RunConfig& run, const PrepareOptions& options = {});

// What PrepareDataset would say of the folder. Writes nothing.
void ValidateDataset(const RunConfig& run);

// Source files of the run's task and features that hold something else than when the dataset was
// begun; empty for a dataset without a manifest.
std::vector<std::string> ChangedCode(const std::string& dataset, const RunConfig& run);

// SpecError unless the dataset was prepared for this run. Writes nothing. What the run is made from
// here and now.
RunInputs RequireSameRun(const RunConfig& run);

}  // namespace robocell
