// The long form of a test: more seeds, builds or objects of the same kind. For tests only.
//
// `make test` tries some of each kind; `make check-proofs` runs the programs with long forms again
// with the environment variable ROBOCELL_LONG_FORM set to 1. A bound or an assertion is the same in both forms.
//
//   const int builds = LongForm() ? 1000 : 100;
#pragma once

#include <cstdlib>
#include <string_view>

namespace robocell {

// Returns true if the environment variable ROBOCELL_LONG_FORM is "1".
inline bool LongForm() {
  const char* value = std::getenv("ROBOCELL_LONG_FORM");
  return value != nullptr && std::string_view(value) == "1";
}

}  // namespace robocell
