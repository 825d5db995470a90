// For tests only: lists the differences between two models, field by field, over everything in a
// model.
#pragma once

#include <mujoco/mjxmacro.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

namespace robocell {

template <class T>
double LargestDifference(const T* a, const T* b, size_t n) {
  if (n == 0 || std::memcmp(a, b, n * sizeof(T)) == 0) return 0;  // the usual case
  double largest = 0;
  for (size_t i = 0; i < n; ++i) {
    const double difference = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    largest = std::max(largest, difference / std::max(1.0, std::abs(static_cast<double>(a[i]))));
  }
  return largest;
}

// Returns "" if all sizes agree and all numbers agree within `tolerance` (relative above 1); else
// one line for each differing field. Fields whose names start with one of `except` are left out.
inline std::string ModelDifferences(const mjModel* m, const mjModel* other, double tolerance,
                                    std::initializer_list<const char*> except = {}) {
  std::string out;
  const auto skipped = [&](const std::string& field) {
    return std::any_of(except.begin(), except.end(),
                       [&](const char* e) { return field.rfind(e, 0) == 0; });
  };
#define X(name)                                                  \
  if (!skipped(#name) && m->name != other->name)                 \
    out += std::string(#name) + ": " + std::to_string(m->name) + \
           " != " + std::to_string(other->name) + "\n";
  MJMODEL_SIZES
#undef X
  if (!out.empty()) return out;
  MJMODEL_POINTERS_PREAMBLE(m)
#define X(type, name, nr, nc)                                                                    \
  if (!skipped(#name)) {                                                                         \
    const double d = LargestDifference(m->name, other->name, static_cast<size_t>(m->nr) * (nc)); \
    if (!(d <= tolerance)) out += std::string(#name) + ": " + std::to_string(d) + "\n";          \
  }
  MJMODEL_POINTERS
#undef X
  return out;
}

}  // namespace robocell
