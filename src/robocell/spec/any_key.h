// Private to spec: how a SourceMap (locations.h) tells maps, whose keys are names of the user's,
// from specs, whose fields are declared.
#pragma once

#include <string_view>

namespace robocell {

// Behind the path of every map of a spec that was read, given or not: "home.*" -> "".
inline constexpr std::string_view kAnyKey = ".*";

}  // namespace robocell
