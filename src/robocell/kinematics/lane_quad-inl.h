// A vector of three, and a fourth number, in as many registers as it takes. Included once for each
// instruction set.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Fours = hn::CappedTag<double, 4>;
constexpr Fours kFours;
constexpr int kPartOfFour = HWY_MIN(4, HWY_MAX_BYTES / 8);
constexpr int kPartsOfFour = 4 / kPartOfFour;

struct Quad {
  hn::Vec<Fours> part[kPartsOfFour];
};

HWY_INLINE Quad QuadAt(const double* p) {
  Quad q;
  for (int k = 0; k < kPartsOfFour; ++k) q.part[k] = hn::Load(kFours, p + k * kPartOfFour);
  return q;
}
HWY_INLINE void Put(const Quad& q, double* p) {
  for (int k = 0; k < kPartsOfFour; ++k) hn::Store(q.part[k], kFours, p + k * kPartOfFour);
}
HWY_INLINE void PutAnywhere(const Quad& q, double* p) {
  for (int k = 0; k < kPartsOfFour; ++k) hn::StoreU(q.part[k], kFours, p + k * kPartOfFour);
}
HWY_INLINE Quad ZeroQuad() {
  Quad q;
  for (auto& part : q.part) part = hn::Zero(kFours);
  return q;
}
HWY_INLINE Quad Times(double s, const Quad& a) {
  Quad out;
  const auto factor = hn::Set(kFours, s);
  for (int k = 0; k < kPartsOfFour; ++k) out.part[k] = hn::Mul(factor, a.part[k]);
  return out;
}
// s * a + b
HWY_INLINE Quad MulAdd(double s, const Quad& a, const Quad& b) {
  Quad out;
  const auto factor = hn::Set(kFours, s);
  for (int k = 0; k < kPartsOfFour; ++k) out.part[k] = hn::MulAdd(factor, a.part[k], b.part[k]);
  return out;
}

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
