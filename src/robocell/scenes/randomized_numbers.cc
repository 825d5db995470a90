#include "robocell/scenes/randomized_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"

namespace robocell::internal {

const std::vector<double>& NumbersOf(const RandomizedValue& value, size_t count,
                                     const std::string& name) {
  const bool is_sound =
      value.word.empty() && value.numbers.size() == count &&
      std::ranges::all_of(value.numbers, [](double x) { return std::isfinite(x); });
  if (!is_sound) {
    throw ArgumentError(fmt::format("randomized value '{}' must be {}", name,
                                    count == 1 ? "a number" : "red, green and blue"));
  }
  return value.numbers;
}

double NumberOf(const RandomizedValue& value, const std::string& name) {
  return NumbersOf(value, 1, name).front();
}

double NumberOf(const RandomizedValues& values, const std::string& name, double otherwise) {
  const RandomizedValue* value = values.find(name);
  return value ? NumberOf(*value, name) : otherwise;
}

}  // namespace robocell::internal
