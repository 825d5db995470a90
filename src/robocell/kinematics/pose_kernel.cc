#include "robocell/kinematics/pose_kernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/kinematics/pose_kernel.cc"
// The targets of lane_kernel.cc.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/kinematics/lane_math-inl.h"
#include "robocell/kinematics/link_math-inl.h"
#include "robocell/kinematics/pose_rows-inl.h"
// Each needs the previous ones.
#include "robocell/kinematics/pose_numbers-inl.h"

#include "robocell/kinematics/pose_chain-inl.h"

#include "robocell/kinematics/pose_steps-inl.h"

#include "robocell/kinematics/pose_dynamics-inl.h"
#include "robocell/kinematics/pose_jacobian-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Returns how many numbers a result has.
int NumbersOf(PosePart part, int n) {
  switch (part) {
    case PosePart::kTip:
      return 16;
    case PosePart::kJacobian:
      return 6 * n;
    case PosePart::kGravity:
    case PosePart::kMotion:
      return n;
    case PosePart::kMass:
      return n * n;
    case PosePart::kManipulability:
      return 1;
  }
  return 0;
}
constexpr int kMostNumbers = kMaxChainJoints * kMaxChainJoints;
static_assert(kMaxChainJoints >= 6);

// Prefetches, part by part, the cache lines that rows of results will be written to, and some of
// the next ones. Such rows begin anywhere in a line, and a write to a far line would delay those
// after it.
class LinesToWrite {
 public:
  HWY_INLINE LinesToWrite(const double* rows, int numbers, int parts)
      : next_(rows), runs_((numbers + parts * kRun - 1) / (parts * kRun)) {}

  HWY_INLINE void BringPart() {
    for (const double* end = next_ + runs_ * kRun; next_ != end; next_ += kRun) {
#pragma GCC unroll 4
      for (int k = 0; k < kRun; k += kLine) hwy::Prefetch(next_ + k);
    }
  }

 private:
  static constexpr int kLine = 8, kRun = 4 * kLine;  // numbers

  const double* next_;
  int runs_;  // runs of a part
};
// Writes of few numbers are not delayed for long.
constexpr int kFewNumbers = 16;

// Computes the results of one query per lane.
template <class Chain>
void ComputeLanes(const Chain& chain, PosePart part, const PoseQuery& query, std::size_t first,
                  double* out, double* tips) {
  const std::size_t last = query.count - 1;
  const int n = chain.n(), numbers = NumbersOf(part, n);
  const int parts = JointMoves::PairsOf(n);
  LinesToWrite lines(out, numbers > kFewNumbers ? kWidth * numbers : 0, parts);
  LinesToWrite tip_lines(tips, tips ? kWidth * 16 : 0, parts);
  const JointMoves moves(chain.t, Inputs(query.q, first, last, n), [&]() POSE_INLINE {
    lines.BringPart();
    tip_lines.BringPart();
  });
  switch (part) {
    case PosePart::kTip:
      return TipsOf(chain, moves, out);
    case PosePart::kJacobian:
      return JacobiansOf(chain, moves, out, tips);
    case PosePart::kGravity:
      return GravitiesOf(chain, moves, Inputs(query.gravity, first, last, 3), out);
    case PosePart::kMass:
      return MassesOf(chain, moves, out);
    case PosePart::kMotion:
      return MotionsOf(AnyChain{chain.t}, moves, Inputs(query.qd, first, last, n),
                       Inputs(query.qdd, first, last, n), Inputs(query.gravity, first, last, 3),
                       out);
    case PosePart::kManipulability:
      return ManipulabilitiesOf(AnyChain{chain.t}, moves, out);
  }
}

template <class Chain>
void ComputeAll(const Chain& chain, PosePart part, const PoseQuery& query, double* out,
                double* tips) {
  const std::size_t numbers = NumbersOf(part, chain.n());
  const std::size_t rest = query.count % kWidth, whole = query.count - rest;
  for (std::size_t first = 0; first < whole; first += kWidth)
    ComputeLanes(chain, part, query, first, out + first * numbers,
                 tips ? tips + first * 16 : nullptr);
  if (rest == 0) return;
  alignas(64) double last[kWidth * kMostNumbers], last_tips[kWidth * 16];
  ComputeLanes(chain, part, query, whole, last, tips ? last_tips : nullptr);
  std::copy_n(last, rest * numbers, out + whole * numbers);
  if (tips) std::copy_n(last_tips, rest * 16, tips + whole * 16);
}

void ComputeChain(const PoseTable& t, PosePart part, const PoseQuery& query, double* out,
                  double* tips) {
  // Most arms are of this kind, if there are enough registers for lanes.
  if (kWidth > 1 && t.plain) {
    if (t.n == 6) return ComputeAll(PlainChain<6>{t}, part, query, out, tips);
    if (t.n == 7) return ComputeAll(PlainChain<7>{t}, part, query, out, tips);
  }
  ComputeAll(AnyChain{t}, part, query, out, tips);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell::internal {

HWY_EXPORT(ComputeChain);

void ComputePoses(const PoseTable& table, PosePart part, const PoseQuery& query, double* out,
                  double* tips) {
  HWY_DYNAMIC_DISPATCH(ComputeChain)(table, part, query, out, tips);
}

}  // namespace robocell::internal
#endif
