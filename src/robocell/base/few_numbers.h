// Copies and checks of the few numbers of a state or a configuration, made in every control
// tick. In place, 16 bytes at a time and the last 16 once more: for so few, calls and the C
// library's preparations for many take longer than the work.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace robocell {

namespace few_numbers_internal {

using Pair = uint64_t __attribute__((vector_size(16)));

// Of a size that is known here: no call.
inline Pair PairAt(const void* from, size_t at) {
  Pair pair;
  std::memcpy(&pair, static_cast<const char*>(from) + at, sizeof pair);
  return pair;
}

inline void PutPair(const Pair& pair, void* to, size_t at) {
  std::memcpy(static_cast<char*>(to) + at, &pair, sizeof pair);
}

// Of less than 16 bytes; often one number.
inline void CopyLess(const void* from, size_t bytes, void* to) {
  if (bytes == sizeof(double)) {
    std::memcpy(to, from, sizeof(double));
    return;
  }
  for (size_t at = 0; at < bytes; ++at)
    static_cast<char*>(to)[at] = static_cast<const char*>(from)[at];
}

// Of 16 bytes or more.
inline size_t LastPair(size_t bytes) { return bytes - sizeof(Pair); }

}  // namespace few_numbers_internal

// To a place that does not overlap.
[[gnu::always_inline]] inline void CopyFew(const void* from, size_t bytes, void* to) {
  namespace few = few_numbers_internal;
  if (bytes < sizeof(few::Pair)) return few::CopyLess(from, bytes, to);
#pragma GCC unroll 2
  for (size_t at = 0; at < few::LastPair(bytes); at += sizeof(few::Pair))
    few::PutPair(few::PairAt(from, at), to, at);
  few::PutPair(few::PairAt(from, few::LastPair(bytes)), to, few::LastPair(bytes));
}

// Whether no magnitude is larger than `most`, and none NaN. As integers, which have the order of
// magnitudes, those of infinity and NaN above all others: none waits for another.
inline bool FewAreWithin(double most, const double* x, size_t n) {
  namespace few = few_numbers_internal;
  if (n < 2) return n == 0 || std::abs(*x) <= most;
  constexpr uint64_t kSign = uint64_t{1} << 63;
  const uint64_t limit = std::bit_cast<uint64_t>(most);
  const size_t last = few::LastPair(n * sizeof *x);
  few::Pair beyond = limit - (few::PairAt(x, last) & ~kSign);
  for (size_t at = 0; at < last; at += sizeof(few::Pair))
    beyond |= limit - (few::PairAt(x, at) & ~kSign);
  return !((beyond[0] | beyond[1]) & kSign);
}

inline bool FewAreFinite(const double* x, size_t n) {
  return FewAreWithin(std::numeric_limits<double>::max(), x, n);
}

}  // namespace robocell
