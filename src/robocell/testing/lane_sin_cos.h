// The lanes' sine and cosine (kinematics/lane_math-inl.h) for tests of their own.
#pragma once

#include <span>

namespace robocell {

// Computes as many values at a time as there are lanes; `any`: also beyond the range of the
// kernels' inner loops. The number of values must be a multiple of 8.
void LaneSinCos(std::span<const double> angles, bool any, std::span<double> sines,
                std::span<double> cosines);

}  // namespace robocell
