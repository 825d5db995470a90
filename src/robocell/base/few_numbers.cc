#include "robocell/base/few_numbers.h"

#include <bit>
#include <cstring>
#include <limits>

namespace robocell {
namespace {

using Pair = uint64_t __attribute__((vector_size(16)));

// A word of a size that is known here is no call.
template <class Word>
Word WordAt(const void* from, size_t at) {
  Word word;
  std::memcpy(&word, static_cast<const char*>(from) + at, sizeof word);
  return word;
}

template <class Word>
void CopyWord(const void* from, size_t at, void* to) {
  const Word word = WordAt<Word>(from, at);
  std::memcpy(static_cast<char*>(to) + at, &word, sizeof word);
}

}  // namespace

void CopyFew(const void* from, size_t bytes, void* to) {
  size_t at = 0;
  for (; at + sizeof(Pair) <= bytes; at += sizeof(Pair)) CopyWord<Pair>(from, at, to);
  if (bytes & 8) CopyWord<uint64_t>(from, at, to);
  for (at = bytes & ~size_t{7}; at < bytes; ++at) CopyWord<char>(from, at, to);
}

uint64_t DifferenceOfFew(const void* a, const void* b, size_t bytes) {
  Pair pairs = {};
  uint64_t rest = 0;
  size_t at = 0;
  for (; at + sizeof(Pair) <= bytes; at += sizeof(Pair))
    pairs |= WordAt<Pair>(a, at) ^ WordAt<Pair>(b, at);
  if (bytes & 8) rest = WordAt<uint64_t>(a, at) ^ WordAt<uint64_t>(b, at);
  for (at = bytes & ~size_t{7}; at < bytes; ++at)
    rest |= static_cast<uint64_t>(WordAt<char>(a, at) != WordAt<char>(b, at));
  return rest | pairs[0] | pairs[1];
}

// As integers, which have the order of magnitudes, those of infinity and NaN above all others: none
// waits for another.
bool FewAreWithin(double most, const double* x, size_t n) {
  constexpr uint64_t kSign = uint64_t{1} << 63;
  const uint64_t limit = std::bit_cast<uint64_t>(most);
  uint64_t beyond = 0;
  for (size_t i = 0; i < n; ++i) beyond |= limit - (std::bit_cast<uint64_t>(x[i]) & ~kSign);
  return !(beyond & kSign);
}

bool FewAreFinite(const double* x, size_t n) {
  return FewAreWithin(std::numeric_limits<double>::max(), x, n);
}

}  // namespace robocell
