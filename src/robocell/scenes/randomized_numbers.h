// Private to scenes: reads numbers of randomised values. Throws ArgumentError, with the name, for a
// value of another form.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "robocell/spec/randomize_config.h"

namespace robocell::internal {

// Returns the numbers of a value, of which there must be `count`.
const std::vector<double>& NumbersOf(const RandomizedValue& value, size_t count,
                                     const std::string& name);
double NumberOf(const RandomizedValue& value, const std::string& name);
double NumberOf(const RandomizedValues& values, const std::string& name, double otherwise);

}  // namespace robocell::internal
