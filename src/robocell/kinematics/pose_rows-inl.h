// Numbers of one configuration per lane: in memory one configuration after the other, in registers
// side by side. Included once for each instruction set.
#include <hwy/highway.h>

#include <algorithm>

#include "robocell/kinematics/pose_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Configurations = hn::CappedTag<double, 8>;
using P = hn::Vec<Configurations>;
constexpr Configurations kPoses;
constexpr int kWidth = hn::MaxLanes(kPoses);
static_assert(kMaxChainJoints % kWidth == 0);

#if HWY_MAX_BYTES >= 64
// Returns a0 b0 a2 b2 and a1 b1 a3 b3, where each is a block of two numbers.
HWY_INLINE void ExchangeBlocks(P a, P b, P* low, P* high) {
#if HWY_ARCH_X86
  // One instruction each, which this release of Highway does not wrap.
  const __m512i evens = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  const __m512i odds = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  *low = P{_mm512_permutex2var_pd(a.raw, evens, b.raw)};
  *high = P{_mm512_permutex2var_pd(a.raw, odds, b.raw)};
#else
  *low = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b), a);
  *high = hn::OddEvenBlocks(b, hn::SwapAdjacentBlocks(a));
#endif
}
#endif

// Exchanges, between two rows of a square at this distance, the parts of the other's columns.
template <int kApart>
HWY_INLINE void Exchange(P* low, P* high) {
  const P a = *low, b = *high;
#if HWY_MAX_BYTES >= 64
  if (kApart == 2) {
    ExchangeBlocks(a, b, low, high);
    return;
  }
#endif
#if HWY_MAX_BYTES >= 16
  if (kApart == 1) {
    *low = hn::InterleaveLower(kPoses, a, b);
    *high = hn::InterleaveUpper(kPoses, a, b);
    return;
  }
  *low = hn::ConcatLowerLower(kPoses, b, a);
  *high = hn::ConcatUpperUpper(kPoses, b, a);
#endif
}

// Transposes a square: in its halves, then in halves of these.
template <int kApart = kWidth / 2>
HWY_INLINE void Transpose(P* rows) {
  if constexpr (kApart > 0) {
#pragma GCC unroll 8
    for (int k = 0; k < kWidth; ++k) {
      if ((k & kApart) == 0) Exchange<kApart>(rows + k, rows + k + kApart);
    }
    Transpose<kApart / 2>(rows);
  }
}

// Lanes after the last configuration repeat it.
class Inputs {
 public:
  HWY_INLINE Inputs(const PoseRows& rows, std::size_t first, std::size_t last, int numbers) {
    if (rows.stride == 0) {
      for (int k = 0; k < numbers; ++k)
        hn::Store(hn::Set(kPoses, rows.data[k]), kPoses, values_[k]);
      return;
    }
    const double* from[kWidth];
#pragma GCC unroll 8
    for (int lane = 0; lane < kWidth; ++lane)
      from[lane] = rows.data + std::min(first + lane, last) * rows.stride;
    if (numbers < kWidth) {
      ReadSquare<true>(from, 0, numbers);
      return;
    }
    int k = 0;
    for (; k + kWidth <= numbers; k += kWidth) ReadSquare<false>(from, k, kWidth);
    // Reads some numbers twice.
    if (k < numbers) ReadSquare<false>(from, numbers - kWidth, kWidth);
  }
  HWY_INLINE P operator[](int k) const { return hn::Load(kPoses, values_[k]); }

 private:
  // Does not touch memory after the numbers.
  template <bool kPart>
  HWY_INLINE void ReadSquare(const double* const* from, int first, int some) {
    P square[kWidth];
#pragma GCC unroll 8
    for (int lane = 0; lane < kWidth; ++lane) {
      const double* numbers = from[lane] + first;
      square[lane] = kPart ? ReadPart(numbers, some) : hn::LoadU(kPoses, numbers);
    }
    Transpose(square);
#pragma GCC unroll 8
    for (int i = 0; i < kWidth; ++i) hn::Store(square[i], kPoses, values_[first + i]);
  }
  // Reads the first of a register's numbers, and 0 for the rest.
  static HWY_INLINE P ReadPart(const double* from, int numbers) {
// With AVX2, only reads of numbers shorter than these could fault.
#if HWY_MEM_OPS_MIGHT_FAULT && HWY_TARGET != HWY_AVX2
    alignas(64) double values[kWidth] = {};
    std::copy_n(from, numbers, values);
    return hn::Load(kPoses, values);
#else
    return hn::MaskedLoad(hn::FirstN(kPoses, numbers), kPoses, from);
#endif
  }

  alignas(64) double values_[kMaxChainJoints][kWidth];
};

template <int kMost>
class Outputs {
 public:
  HWY_INLINE void Put(int k, P value) { hn::Store(value, kPoses, values_[k]); }
  // Writes the numbers of all lanes.
  HWY_INLINE void Write(int numbers, double* out) const {
    if (numbers == 1) return hn::StoreU(At(0), kPoses, out);
    if (numbers < kWidth) return WriteSquare<true>(0, numbers, numbers, out);
    const int rest = numbers % kWidth, whole = numbers - rest;
    for (int k = 0; k < whole; k += kWidth) WriteSquare<false>(k, kWidth, numbers, out);
    if (rest > kFew) {
      // Writes some numbers twice.
      WriteSquare<false>(numbers - kWidth, kWidth, numbers, out);
    } else {
      for (int k = whole; k < numbers; ++k) WriteNumber(k, numbers, out);
    }
  }

 private:
  // Up to this number, single writes are faster than a square.
  static constexpr int kFew = 2;

  HWY_INLINE P At(int k) const { return hn::Load(kPoses, values_[k]); }
  HWY_INLINE void WriteNumber(int k, int numbers, double* out) const {
#pragma GCC unroll 8
    for (int lane = 0; lane < kWidth; ++lane) out[lane * numbers + k] = values_[k][lane];
  }
  template <bool kPart>
  HWY_INLINE void WriteSquare(int first, int some, int numbers, double* out) const {
    P square[kWidth];
#pragma GCC unroll 8
    for (int i = 0; i < kWidth; ++i)
      square[i] = kPart && i >= some ? hn::Zero(kPoses) : At(first + i);
    Transpose(square);
    const auto wanted = hn::FirstN(kPoses, some);
#pragma GCC unroll 8
    for (int lane = 0; lane < kWidth; ++lane) {
      double* to = out + lane * numbers + first;
      if (kPart) {
        hn::BlendedStore(square[lane], wanted, kPoses, to);
      } else {
        hn::StoreU(square[lane], kPoses, to);
      }
    }
  }

  alignas(64) double values_[kMost][kWidth];
};

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
