// The version of robocell, as recorded in episodes and printed by the command line.
#pragma once

#include <string_view>

namespace robocell {

// "0.1.0", from the build.
std::string_view Version();

}  // namespace robocell
