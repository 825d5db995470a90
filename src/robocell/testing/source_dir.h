// Where the project's own files lie that tests read. Compiled into one file, not into every test:
// what a compiler cache keeps of the tests then serves every checkout.
#pragma once

#include <string>

namespace robocell {

// The root of the checkout that was built, without a slash at the end.
std::string SourceDir();

}  // namespace robocell
