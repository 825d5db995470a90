// Checks of `pinned` (randomize_config.h): each name means a value, and each value is one that could
// be drawn.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "robocell/spec/problems.h"
#include "robocell/spec/randomize_config.h"

namespace robocell::internal {

// Reports values outside of the range of their names, of another form, and names that no value has.
// Whether a target is there is known with a scene (scenes/randomization.h).
void ValidatePinned(const RandomizeConfig& config, Problems& problems);

// Returns true for a value of the look of a target: "table/texture", "cube/colour_scale".
bool IsLookName(std::string_view name);

// Returns the longest delay of actions, s, that is drawn or pinned; unset without one.
std::optional<double> LongestDelay(const RandomizeConfig& config);

// Reports textures that are neither made nor names of files.
void ValidateTexture(const std::string& texture, std::string_view field, Problems& problems);

}  // namespace robocell::internal
