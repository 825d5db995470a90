#include "robocell/testing/lane_sin_cos.h"

#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/testing/lane_sin_cos.cc"
// The same targets as in kinematics/lane_kernel.cc.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/kinematics/lane_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
using namespace internal::HWY_NAMESPACE;

void SinesAndCosines(const double* angles, bool any, std::size_t count, double* sines,
                     double* cosines) {
  const hn::CappedTag<double, 8> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto x = hn::LoadU(d, angles + i);
    auto sine = x, cosine = x;
    if (any) {
      SinCosOfAny(d, x, &sine, &cosine);
    } else {
      SinCos(d, x, &sine, &cosine);
    }
    hn::StoreU(sine, d, sines + i);
    hn::StoreU(cosine, d, cosines + i);
  }
}

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell {

HWY_EXPORT(SinesAndCosines);

void LaneSinCos(std::span<const double> angles, bool any, std::span<double> sines,
                std::span<double> cosines) {
  HWY_DYNAMIC_DISPATCH(SinesAndCosines)
  (angles.data(), any, angles.size(), sines.data(), cosines.data());
}

}  // namespace robocell
#endif
