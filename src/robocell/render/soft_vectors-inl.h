// Vectors of three and powers, a register at a time; part of soft_kernel.cc, compiled for each
// instruction set.
#if defined(ROBOCELL_SOFT_VECTORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_VECTORS_INL_H_
#undef ROBOCELL_SOFT_VECTORS_INL_H_
#else
#define ROBOCELL_SOFT_VECTORS_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>
#include <cstring>

#include "robocell/render/soft_blocks-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

struct V3 {
  V x, y, z;
};
struct Colour {
  V r, g, b;
};

HWY_INLINE V Dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE V3 Cross(const V3& a, const V3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE V3 Add(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 Sub(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 Times(V s, const V3& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE V3 Set3(const float* v) { return {Num(v[0]), Num(v[1]), Num(v[2])}; }
HWY_INLINE V Clamp01(V v) { return hn::Min(hn::Max(v, hn::Zero(kFloats)), Num(1)); }
// Computes 1 / sqrt(x) within 5e-6, for numbers from 1e-30 on: Newton's method from a guess by the
// bits. It is faster than a division and a root, and the same everywhere, unlike the processors'
// own estimates.
constexpr int32_t kGuess = 0x5f375a86;
HWY_INLINE V PerRoot(V x) {
  V y = hn::BitCast(kFloats,
                    hn::Sub(hn::Set(kInts, kGuess), hn::ShiftRight<1>(hn::BitCast(kInts, x))));
  const V half = hn::Mul(Num(0.5f), x);
  for (int k = 0; k < 2; ++k) {
    y = hn::Mul(y, hn::Sub(Num(1.5f), hn::Mul(half, hn::Mul(y, y))));
  }
  return y;
}
// Returns the same bits for one number.
inline float PerRoot(float x) {
  int32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  bits = kGuess - (bits >> 1);
  float y;
  std::memcpy(&y, &bits, sizeof y);
  const float half = 0.5f * x;
  for (int k = 0; k < 2; ++k) y = y * (1.5f - half * (y * y));
  return y;
}
HWY_INLINE V3 Unit(const V3& a) { return Times(PerRoot(hn::Max(Dot(a, a), Num(1e-30f))), a); }
// Multiplies the first three of each of the `rows` of `stride` numbers by the vector.
HWY_INLINE V3 Turned(const float* rows, int stride, const V3& v) {
  return {Dot(Set3(rows), v), Dot(Set3(rows + stride), v), Dot(Set3(rows + 2 * stride), v)};
}
HWY_INLINE V3 TurnedBack(const float* rows, int stride, const V3& v) {
  return Add(Add(Times(v.x, Set3(rows)), Times(v.y, Set3(rows + stride))),
             Times(v.z, Set3(rows + 2 * stride)));
}

// Takes positive numbers; within 4e-7.
HWY_INLINE V Log2(V x) {
  // x = 2^exponent (1 + t), t from -0.25 to 0.5.
  const I bits = hn::BitCast(kInts, x);
  const I exponent = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(kInts, 0x3f400000)));
  const V t = hn::Sub(hn::BitCast(kFloats, hn::Sub(bits, hn::ShiftLeft<23>(exponent))), Num(1));
  V sum = hn::Add(hn::Mul(t, Num(0.113638227f)), Num(-0.239982767f));
  sum = hn::Add(hn::Mul(t, sum), Num(0.29970316f));
  sum = hn::Add(hn::Mul(t, sum), Num(-0.362062235f));
  sum = hn::Add(hn::Mul(t, sum), Num(0.480526377f));
  sum = hn::Add(hn::Mul(t, sum), Num(-0.721308641f));
  sum = hn::Add(hn::Mul(t, sum), Num(1.44269851f));
  return hn::Add(hn::ConvertTo(kFloats, exponent), hn::Mul(t, sum));
}
HWY_INLINE V Exp2(V x) {
  const V at = hn::Min(hn::Max(x, Num(-126)), Num(126));
  const V whole = hn::Floor(at), f = hn::Sub(at, whole);
  V sum = hn::Add(hn::Mul(f, Num(0.00133335581f)), Num(0.00961812911f));
  sum = hn::Add(hn::Mul(f, sum), Num(0.0555041087f));
  sum = hn::Add(hn::Mul(f, sum), Num(0.240226507f));
  sum = hn::Add(hn::Mul(f, sum), Num(0.693147181f));
  sum = hn::Add(hn::Mul(f, sum), Num(1));
  const I power = hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(kInts, whole), hn::Set(kInts, 127)));
  return hn::Mul(sum, hn::BitCast(kFloats, power));
}
// Returns the logarithm within 2e-4 and without a division; for levels of textures.
HWY_INLINE V RoughLog2(V x) {
  const I bits = hn::BitCast(kInts, x);
  const V exponent = hn::ConvertTo(kFloats, hn::Sub(hn::ShiftRight<23>(bits), hn::Set(kInts, 127)));
  const V t = hn::Sub(hn::BitCast(kFloats, hn::Or(hn::And(bits, hn::Set(kInts, 0x7fffff)),
                                                  hn::Set(kInts, 0x3f800000))),
                      Num(1));
  V sum = hn::Add(hn::Mul(t, Num(-0.0821343f)), Num(0.3218812f));
  sum = hn::Add(hn::Mul(t, sum), Num(-0.6777572f));
  sum = hn::Add(hn::Mul(t, sum), Num(1.4380103f));
  return hn::Add(exponent, hn::Mul(t, sum));
}
// Returns x to the power of e, for x from 0 to 1.
HWY_INLINE V Power(V x, float e) {
  if (e == 0) return Num(1);
  const V value = Exp2(hn::Mul(Num(e), Log2(hn::Max(x, Num(1e-30f)))));
  return hn::IfThenElseZero(hn::Gt(x, Num(1e-30f)), value);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
