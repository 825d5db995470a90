// Points that fill the unit cube evenly, in a fixed order: starts of solvers, and choices that
// samplers spread over a run.
//
// Richtmyer's sequence (R. D. Richtmyer, "The Evaluation of Definite Integrals, and a Quasi-Monte-
// Carlo Method Based on the Properties of Algebraic Numbers", 1951): the k-th point is the
// fractional part of 1/2 + k * (sqrt 2, sqrt 3, sqrt 5, ...). Point 0 is the centre. Pure: no
// state, no allocation.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "robocell/kinematics/joint_vector.h"

namespace robocell::internal {

// Returns coordinate `dimension` (less than kMaxChainJoints) of point k, in [0, 1).
inline double LowDiscrepancy(int k, int dimension) {
  constexpr std::array<int, kMaxChainJoints> kPrimes = {2,  3,  5,  7,  11, 13, 17, 19,
                                                        23, 29, 31, 37, 41, 43, 47, 53};
  const double x = 0.5 + k * std::sqrt(kPrimes[dimension]);
  return x - std::floor(x);
}

// Returns an element of Van der Corput's sequence in a base: the digits of `index` mirrored at the
// radix point, in [0, 1). With coprime bases these are Halton's points.
inline double RadicalInverse(uint64_t index, uint64_t base) {
  double value = 0, digit = 1.0 / static_cast<double>(base);
  for (; index > 0; index /= base, digit /= static_cast<double>(base))
    value += digit * static_cast<double>(index % base);
  return value;
}

}  // namespace robocell::internal
