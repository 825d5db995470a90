// The version of robocell, as recorded in episodes and printed by the command line.
#pragma once

#include <string_view>

namespace robocell {

// The version of these headers.
inline constexpr const char* kHeaderVersion = "0.1.0";

// Returns the version of the library, from the build.
std::string_view Version();

}  // namespace robocell
