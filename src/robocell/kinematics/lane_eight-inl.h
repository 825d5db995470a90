// Eight numbers, in as many registers as they take: what is computed with them waits as long as one
// register does. Included once for each instruction set.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using PartOfEight = hn::CappedTag<double, 8>;
constexpr PartOfEight kPartOfEight;
constexpr int kLanesOfPart = HWY_MIN(8, HWY_MAX_BYTES / 8);
constexpr int kPartsOfEight = 8 / kLanesOfPart;

struct Eight {
  hn::Vec<PartOfEight> part[kPartsOfEight];
};

// Of aligned numbers.
HWY_INLINE Eight EightAt(const double* p) {
  Eight out;
  for (int k = 0; k < kPartsOfEight; ++k)
    out.part[k] = hn::Load(kPartOfEight, p + k * kLanesOfPart);
  return out;
}
HWY_INLINE void Put(const Eight& a, double* p) {
  for (int k = 0; k < kPartsOfEight; ++k) hn::Store(a.part[k], kPartOfEight, p + k * kLanesOfPart);
}
HWY_INLINE Eight EightTimes(double x) {
  Eight out;
  for (auto& part : out.part) part = hn::Set(kPartOfEight, x);
  return out;
}

HWY_INLINE Eight Add(const Eight& a, const Eight& b) {
  Eight out;
  for (int k = 0; k < kPartsOfEight; ++k) out.part[k] = hn::Add(a.part[k], b.part[k]);
  return out;
}
HWY_INLINE Eight Mul(const Eight& a, const Eight& b) {
  Eight out;
  for (int k = 0; k < kPartsOfEight; ++k) out.part[k] = hn::Mul(a.part[k], b.part[k]);
  return out;
}
HWY_INLINE Eight Div(const Eight& a, const Eight& b) {
  Eight out;
  for (int k = 0; k < kPartsOfEight; ++k) out.part[k] = hn::Div(a.part[k], b.part[k]);
  return out;
}
// a b + c, a b - c, c - a b
HWY_INLINE Eight MulAdd(const Eight& a, const Eight& b, const Eight& c) {
  Eight out;
  for (int k = 0; k < kPartsOfEight; ++k) out.part[k] = hn::MulAdd(a.part[k], b.part[k], c.part[k]);
  return out;
}
HWY_INLINE Eight MulSub(const Eight& a, const Eight& b, const Eight& c) {
  Eight out;
  for (int k = 0; k < kPartsOfEight; ++k) out.part[k] = hn::MulSub(a.part[k], b.part[k], c.part[k]);
  return out;
}
HWY_INLINE Eight NegMulAdd(const Eight& a, const Eight& b, const Eight& c) {
  Eight out;
  for (int k = 0; k < kPartsOfEight; ++k)
    out.part[k] = hn::NegMulAdd(a.part[k], b.part[k], c.part[k]);
  return out;
}

HWY_INLINE double LastOf(const Eight& a) {
  return hn::ExtractLane(a.part[kPartsOfEight - 1], kLanesOfPart - 1);
}
// With another last one.
HWY_INLINE Eight WithLast(const Eight& a, double last) {
  Eight out = a;
  auto& part = out.part[kPartsOfEight - 1];
  const auto before = hn::FirstN(kPartOfEight, kLanesOfPart - 1);
  part = hn::IfThenElse(before, part, hn::Set(kPartOfEight, last));
  return out;
}
HWY_INLINE double SumOf(const Eight& a) {
  auto sum = a.part[0];
  for (int k = 1; k < kPartsOfEight; ++k) sum = hn::Add(sum, a.part[k]);
  return hn::GetLane(hn::SumOfLanes(kPartOfEight, sum));
}

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
