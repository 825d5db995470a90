// The folder of the project's own files that tests read. It is compiled into one file, not into
// every test, so that a compiler cache of the tests serves every checkout.
#pragma once

#include <string>

namespace robocell {

// Returns the root of the built checkout, without a trailing slash.
std::string SourceDir();

}  // namespace robocell
