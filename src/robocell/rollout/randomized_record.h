// The values of `randomize:` in an episode's metadata: {"randomized": {"light/0/intensity": 0.4,
// "cube/colour": [1, 0, 0.2], "table/texture": "wood"}}.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "robocell/data/episode_reader.h"
#include "robocell/spec/randomize_config.h"

namespace robocell::internal {

inline constexpr const char* kRandomized = "randomized";

nlohmann::json RandomizedRecord(const RandomizedValues& values);

// Returns the values of an episode; empty if it has none. Throws IoError, with file and field, for
// values of another form.
RandomizedValues RandomizedOf(const Episode& episode);

}  // namespace robocell::internal
