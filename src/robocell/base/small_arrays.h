// Copies and range checks of arrays of a few numbers (a state, a configuration), which every
// control tick makes. They are inlined and handle 16 bytes at a time, the last 16 overlapping: for
// so few numbers, a call into the C library takes longer than the work.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace robocell {

namespace small_arrays_internal {

using Pair = uint64_t __attribute__((vector_size(16)));

// The compiler knows the size, so it does not emit a call.
inline Pair PairAt(const void* from, size_t at) {
  Pair pair;
  std::memcpy(&pair, static_cast<const char*>(from) + at, sizeof pair);
  return pair;
}

inline void PutPair(const Pair& pair, void* to, size_t at) {
  std::memcpy(static_cast<char*>(to) + at, &pair, sizeof pair);
}

// Copies less than 16 bytes; often one number.
inline void CopyLess(const void* from, size_t bytes, void* to) {
  if (bytes == sizeof(double)) {
    std::memcpy(to, from, sizeof(double));
    return;
  }
  for (size_t at = 0; at < bytes; ++at)
    static_cast<char*>(to)[at] = static_cast<const char*>(from)[at];
}

// Returns the offset of the last pair in 16 bytes or more.
inline size_t LastPair(size_t bytes) { return bytes - sizeof(Pair); }

}  // namespace small_arrays_internal

// Copies to memory that does not overlap.
[[gnu::always_inline]] inline void CopySmall(const void* from, size_t bytes, void* to) {
  namespace few = small_arrays_internal;
  if (bytes < sizeof(few::Pair)) return few::CopyLess(from, bytes, to);
#pragma GCC unroll 2
  for (size_t at = 0; at < few::LastPair(bytes); at += sizeof(few::Pair))
    few::PutPair(few::PairAt(from, at), to, at);
  few::PutPair(few::PairAt(from, few::LastPair(bytes)), to, few::LastPair(bytes));
}

// Returns true if no magnitude is larger than `most` and none is NaN. Magnitudes are compared as
// integers, which have the same order with infinity and NaN above all others.
inline bool AllWithin(double most, const double* x, size_t n) {
  namespace few = small_arrays_internal;
  if (n < 2) return n == 0 || std::abs(*x) <= most;
  constexpr uint64_t kSign = uint64_t{1} << 63;
  const uint64_t limit = std::bit_cast<uint64_t>(most);
  const size_t last = few::LastPair(n * sizeof *x);
  few::Pair beyond = limit - (few::PairAt(x, last) & ~kSign);
  for (size_t at = 0; at < last; at += sizeof(few::Pair))
    beyond |= limit - (few::PairAt(x, at) & ~kSign);
  return !((beyond[0] | beyond[1]) & kSign);
}

inline bool AllFinite(const double* x, size_t n) {
  return AllWithin(std::numeric_limits<double>::max(), x, n);
}

}  // namespace robocell
