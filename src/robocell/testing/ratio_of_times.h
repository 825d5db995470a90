// For tests that something did not become many times slower: measures how long it takes beside
// something else, in the same run. benchmarks/ measures speed.
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>

namespace robocell {

// What our code may take beside the engine's where `optimised` is allowed when it is optimised:
// many times as much in builds for sanitizers and debuggers, which slow the one and not the other.
double Allowed(double optimised);

template <class Function>
double Seconds(const Function& function) {
  const auto begin = std::chrono::steady_clock::now();
  function();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Of the least that each takes, in turn: whatever disturbs a machine only ever adds.
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
