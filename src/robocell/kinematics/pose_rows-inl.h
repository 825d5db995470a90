// Numbers of as many configurations as there are lanes: in memory one configuration after the
// other, in registers side by side. Included once for each instruction set.
#include <hwy/highway.h>

#include <algorithm>

#include "robocell/kinematics/pose_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Configurations = hn::CappedTag<double, 8>;
using P = hn::Vec<Configurations>;
constexpr Configurations kPoses;
constexpr int kWidth = hn::MaxLanes(kPoses);
static_assert(kMaxChainJoints % kWidth == 0);

// Two rows of a square, so far apart, exchange what each holds of the other's columns.
template <int kApart>
HWY_INLINE void Exchange(P* low, P* high) {
  const P a = *low, b = *high;
#if HWY_MAX_BYTES >= 64
  if (kApart == 2) {
    *low = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b), a);
    *high = hn::OddEvenBlocks(b, hn::SwapAdjacentBlocks(a));
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

// Makes columns of a square's rows: in its halves, then in halves of these.
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

// Lanes behind the last configuration do what it does.
class Inputs {
 public:
  HWY_INLINE Inputs(const PoseRows& rows, std::size_t first, std::size_t last, int numbers) {
    const double* from[kWidth];
    for (int lane = 0; lane < kWidth; ++lane)
      from[lane] = rows.data + std::min(first + lane, last) * rows.stride;
    for (int k = 0; k < numbers; k += kWidth) {
      P square[kWidth];
#pragma GCC unroll 8
      for (int lane = 0; lane < kWidth; ++lane)
        square[lane] = Read(from[lane] + k, HWY_MIN(numbers - k, kWidth));
      Transpose(square);
#pragma GCC unroll 8
      for (int i = 0; i < kWidth; ++i) hn::Store(square[i], kPoses, values_[k + i]);
    }
  }
  HWY_INLINE P operator[](int k) const { return hn::Load(kPoses, values_[k]); }

 private:
  // The first of a register's numbers, and 0; does not touch what is behind them.
  static HWY_INLINE P Read(const double* from, int numbers) {
#if HWY_MEM_OPS_MIGHT_FAULT
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
  // Of all lanes.
  HWY_INLINE void Write(int numbers, double* out) const {
    if (numbers == 1) return hn::StoreU(At(0), kPoses, out);
    if (numbers < kWidth) return WriteSquare<true>(0, numbers, numbers, out);
    int k = 0;
    for (; k + kWidth <= numbers; k += kWidth) WriteSquare<false>(k, kWidth, numbers, out);
    // Some of these once more.
    if (k < numbers) WriteSquare<false>(numbers - kWidth, kWidth, numbers, out);
  }

 private:
  HWY_INLINE P At(int k) const { return hn::Load(kPoses, values_[k]); }
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

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
