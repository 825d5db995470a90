// Private to spec: lets a SourceMap (locations.h) distinguish maps, whose keys are the user's
// names, from specs, whose fields are declared.
#pragma once

#include <string_view>

namespace robocell {

// Behind the path of every map of a spec that was read, given or not: "home.*" -> "".
inline constexpr std::string_view kAnyKey = ".*";

}  // namespace robocell
