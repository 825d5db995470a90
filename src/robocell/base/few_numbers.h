// Copies and comparisons of the few numbers of a state or a configuration, made in every control
// tick: without the C library's preparations for many, and small, because between two ticks the
// engine takes the processor's first cache for itself.
#pragma once

#include <cstddef>
#include <cstdint>

namespace robocell {

// To a place that does not overlap.
void CopyFew(const void* from, size_t bytes, void* to);

// Not 0 where any bit of the two differs: -0.0 is not 0.0, and a NaN is itself.
uint64_t DifferenceOfFew(const void* a, const void* b, size_t bytes);

// Whether no magnitude is larger than `most`, and none NaN.
bool FewAreWithin(double most, const double* x, size_t n);
bool FewAreFinite(const double* x, size_t n);

}  // namespace robocell
