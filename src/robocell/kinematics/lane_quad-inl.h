// A vector of three, and a fourth number, in as many registers as needed. Included once for each
// instruction set.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
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
// Loads three numbers from any address; the fourth is 0.
HWY_INLINE Quad ThreeAt(const double* p) {
  if constexpr (kPartsOfFour == 1) {
    return {{hn::MaskedLoad(hn::FirstN(kFours, 3), kFours, p)}};
  } else {
    alignas(32) const double padded[4] = {p[0], p[1], p[2], 0};
    return QuadAt(padded);
  }
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
HWY_INLINE Quad Sub(const Quad& a, const Quad& b) {
  Quad out;
  for (int k = 0; k < kPartsOfFour; ++k) out.part[k] = hn::Sub(a.part[k], b.part[k]);
  return out;
}
// Multiplies element by element.
HWY_INLINE Quad Mul(const Quad& a, const Quad& b) {
  Quad out;
  for (int k = 0; k < kPartsOfFour; ++k) out.part[k] = hn::Mul(a.part[k], b.part[k]);
  return out;
}
// Returns a * b + c.
HWY_INLINE Quad MulAdd(const Quad& a, const Quad& b, const Quad& c) {
  Quad out;
  for (int k = 0; k < kPartsOfFour; ++k) out.part[k] = hn::MulAdd(a.part[k], b.part[k], c.part[k]);
  return out;
}
HWY_INLINE double SumOf(const Quad& q) {
  alignas(32) double p[4];
  Put(q, p);
  return (p[0] + p[1]) + (p[2] + p[3]);
}
HWY_INLINE Quad Add(const Quad& a, const Quad& b) {
  Quad out;
  for (int k = 0; k < kPartsOfFour; ++k) out.part[k] = hn::Add(a.part[k], b.part[k]);
  return out;
}
// Returns the second, third and first number; the fourth stays.
HWY_INLINE Quad Yzx(const Quad& q) {
  if constexpr (kPartsOfFour == 1) {
    alignas(32) constexpr int64_t kOrder[4] = {1, 2, 0, 3};
    return {{hn::TableLookupLanes(q.part[0], hn::SetTableIndices(kFours, kOrder))}};
  } else {
    alignas(32) double p[4];
    Put(q, p);
    const double x = p[0];
    p[0] = p[1];
    p[1] = p[2];
    p[2] = x;
    return QuadAt(p);
  }
}
// Computes the cross product before its last rotation of elements, which a sum of them does once.
HWY_INLINE Quad UnturnedCross(const Quad& a, const Quad& b) {
  const Quad y = Yzx(b), ab = Yzx(a);
  Quad z;
  for (int k = 0; k < kPartsOfFour; ++k)
    z.part[k] = hn::MulSub(a.part[k], y.part[k], hn::Mul(ab.part[k], b.part[k]));
  return z;
}
HWY_INLINE Quad Cross(const Quad& a, const Quad& b) { return Yzx(UnturnedCross(a, b)); }

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
