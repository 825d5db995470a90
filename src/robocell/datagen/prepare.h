// The folder of a run's dataset: made with its manifest before the first episode, recognised when
// the run goes on.
#pragma once

#include <string>
#include <vector>

#include "robocell/spec/run_config.h"

namespace robocell {

// Creates the dataset's folder with its manifest, or checks that the folder there belongs to the
// same run: another identity is a SpecError that shows the lines that differ, and so is a folder
// with other things in it. IoError when the folder cannot be written. Any number of processes may
// call it for the same run.
void PrepareDataset(const RunConfig& run);

// The lines of two texts that are not in both, in their order: "- old line", "+ new line".
std::vector<std::string> DifferingLines(const std::string& old_text, const std::string& new_text);

}  // namespace robocell
