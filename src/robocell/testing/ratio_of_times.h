// For tests that some code did not become many times slower: measures its time beside that of other
// code, in the same run. benchmarks/ measures speed.
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>

namespace robocell {

// Returns the allowed ratio of our time to the engine's, where `optimised` applies to optimised
// builds: many times more for sanitizers and debuggers, which slow only our code down.
double Allowed(double optimised);

template <class Function>
double Seconds(const Function& function) {
  const auto begin = std::chrono::steady_clock::now();
  function();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Compares the shortest times of alternating runs: disturbances only ever add time.
template <class One, class Other>
double RatioOfTimes(const One& one, const Other& other) {
  double first = std::numeric_limits<double>::infinity(), second = first;
  for (int repetition = 0; repetition < 20; ++repetition) {
    first = std::min(first, Seconds(one));
    second = std::min(second, Seconds(other));
  }
  return first / second;
}

}  // namespace robocell
