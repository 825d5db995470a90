// A dataset whose dataset.json was lost: its episodes say what it was.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/run_config.h"

namespace robocell {

// What the episodes in the run's dataset were made with that is different now, as RunOrigin says
// it; nothing when the manifest can be written again. Unset when there are no generated episodes.
std::optional<std::vector<std::string>> ChangesSinceEpisodes(const RunConfig& run);

}  // namespace robocell
