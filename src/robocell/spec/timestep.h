// The longest step of the engine that makes sense: a larger number was meant in another unit.
#pragma once

#include <fmt/format.h>

#include <string_view>

#include "robocell/spec/problems.h"

namespace robocell {

constexpr double kLongestTimestep = 0.1;  // seconds

// Adds a problem at `field` for a longer one. `per_second`: 1 for a value in s, 1000 for ms.
inline void CheckTimestep(double value, double per_second, std::string_view field,
                          Problems& problems) {
  const char* unit = per_second == 1 ? "s" : "ms";
  if (value <= kLongestTimestep * per_second) return;
  problems.AddAt(
      field,
      fmt::format("{:g} {} is too long for a step of the engine, at most {:g} {}; "
                  "{:g} {} is usual",
                  value, unit, kLongestTimestep * per_second, unit, 0.002 * per_second, unit));
}

}  // namespace robocell
