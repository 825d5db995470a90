// For tests only: messages of ParseYaml.
#pragma once

#include <string>

#include "robocell/base/error.h"
#include "robocell/spec/validate.h"
#include "robocell/spec/yaml.h"

namespace robocell::testing {

// Returns the message of the SpecError, or "" for a valid text. The source is called "f.yaml".
template <class T>
std::string ParseError(const std::string& text) {
  try {
    ParseYaml<T>(text, "f.yaml");
    return "";
  } catch (const SpecError& e) {
    return e.what();
  }
}

// The same for checks on a spec made in code.
template <class T>
std::string ValidationError(const T& spec, const std::string& what = "it") {
  try {
    RequireValid(spec, what);
    return "";
  } catch (const SpecError& e) {
    return e.what();
  }
}

}  // namespace robocell::testing
