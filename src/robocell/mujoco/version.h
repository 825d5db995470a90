// The version gate: robocell only runs with the MuJoCo version that it was compiled for, because
// struct layouts change between releases without any other sign. The first guarded engine call
// calls it; call it yourself to fail earlier.
#pragma once

#include <string>

namespace robocell {

// Throws Error with both versions and the command that fixes it.
void RequireEngineVersion();

// Returns "4.0.0": the version this library was compiled for.
std::string CompiledEngineVersion();
// Returns "4.0.0": the version that is loaded.
std::string LoadedEngineVersion();

namespace version_internal {
// Formats a version number: 4000000 -> "4.0.0".
std::string VersionText(int version);
void RequireVersions(int compiled, int loaded);
}  // namespace version_internal

}  // namespace robocell
