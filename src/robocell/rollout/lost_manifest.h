// A dataset whose dataset.json was lost: its episodes say what it was.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/run_config.h"

namespace robocell {

// Differences between the present inputs and those of the episodes in the run's dataset, as
// RunOrigin returns them; empty if the manifest can be written again. Unset without generated
// episodes.
std::optional<std::vector<std::string>> ChangesSinceEpisodes(const RunConfig& run);

}  // namespace robocell
