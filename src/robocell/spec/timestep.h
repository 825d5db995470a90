// The shortest and the longest useful engine step: a number beyond was meant in another unit. With
// a shorter step nothing ever ends: at 10 us a simulated second is 100 000 steps.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "robocell/spec/problems.h"

namespace robocell::internal {

constexpr double kShortestTimestep = 1e-5, kLongestTimestep = 0.1;  // seconds

// Returns the problem of a step; "" if it is valid. `per_second`: 1 for a value in s, 1000 for ms.
inline std::string TimestepProblem(double value, double per_second) {
  const bool too_long = value > kLongestTimestep * per_second;
  if (!too_long && !(value > 0 && value < kShortestTimestep * per_second)) return "";
  const char* unit = per_second == 1 ? "s" : "ms";
  return fmt::format("{:g} {} is too {} for a step of the engine, at {} {:g} {}; {:g} {} is usual",
                     value, unit, too_long ? "long" : "short", too_long ? "most" : "least",
                     (too_long ? kLongestTimestep : kShortestTimestep) * per_second, unit,
                     0.002 * per_second, unit);
}

// Adds that problem at `field`.
inline void ValidateTimestep(double value, double per_second, std::string_view field,
                             Problems& problems) {
  const std::string problem = TimestepProblem(value, per_second);
  if (!problem.empty()) problems.AddAt(field, problem);
}

}  // namespace robocell::internal
