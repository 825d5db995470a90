// Patterns of names: `*` stands for any part of a name, `?` for any one character.
//
//   FitsPattern("robots/*/sensors/*", "robots/left/sensors/touch");   // true
#pragma once

#include <string_view>

namespace robocell::internal {

// The time grows with the product of both lengths at most, whatever the pattern is.
bool FitsPattern(std::string_view pattern, std::string_view name);

// Returns true if the text has a `*` or a `?`.
bool IsNamePattern(std::string_view text);

}  // namespace robocell::internal
