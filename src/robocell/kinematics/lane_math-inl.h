// Sine and cosine of all lanes. Included once for each instruction set.
#include <hwy/highway.h>

#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Computes both within about one unit in the last place for |x| < 1e5. Reduction by quarter turns
// in three parts and minimax polynomials as in fdlibm (Sun Microsystems, 1993).
template <class D, class V = hn::Vec<D>>
HWY_INLINE void SinCos(D d, V x, V* sine, V* cosine) {
  const hn::RebindToUnsigned<D> du;
  // Adding this number leaves the nearest integer in the low bits.
  const V magic = hn::Set(d, 6755399441055744.0);
  const V shifted = hn::MulAdd(x, hn::Set(d, 0.63661977236758134308), magic);
  const auto quarter = hn::BitCast(du, shifted);
  const V turns = hn::Sub(shifted, magic);
  V r = hn::NegMulAdd(turns, hn::Set(d, 1.57079632673412561417e+00), x);
  r = hn::NegMulAdd(turns, hn::Set(d, 6.07710050630396597660e-11), r);
  r = hn::NegMulAdd(turns, hn::Set(d, 2.02226624879595063154e-21), r);

  const V r2 = hn::Mul(r, r);
  V s = hn::MulAdd(r2, hn::Set(d, 1.58969099521155010221e-10),
                   hn::Set(d, -2.50507602534068634195e-08));
  s = hn::MulAdd(r2, s, hn::Set(d, 2.75573137070700676789e-06));
  s = hn::MulAdd(r2, s, hn::Set(d, -1.98412698298579493134e-04));
  s = hn::MulAdd(r2, s, hn::Set(d, 8.33333333332248946124e-03));
  s = hn::MulAdd(r2, s, hn::Set(d, -1.66666666666666324348e-01));
  s = hn::MulAdd(hn::Mul(r2, r), s, r);
  V c = hn::MulAdd(r2, hn::Set(d, -1.13596475577881948265e-11),
                   hn::Set(d, 2.08757232129817482790e-09));
  c = hn::MulAdd(r2, c, hn::Set(d, -2.75573143513906633035e-07));
  c = hn::MulAdd(r2, c, hn::Set(d, 2.48015872894767294178e-05));
  c = hn::MulAdd(r2, c, hn::Set(d, -1.38888888888741095749e-03));
  c = hn::MulAdd(r2, c, hn::Set(d, 4.16666666666666019037e-02));
  c = hn::MulAdd(hn::Mul(r2, r2), c, hn::NegMulAdd(r2, hn::Set(d, 0.5), hn::Set(d, 1.0)));

  // Odd quarters swap; the second and third of the four negate the sine, the first and second the
  // cosine.
  const auto one = hn::Set(du, 1);
  const auto swap = hn::RebindMask(d, hn::TestBit(quarter, one));
  const auto top = hn::Set(du, uint64_t{1} << 63);
  const auto sine_sign = hn::And(hn::ShiftLeft<62>(quarter), top);
  const auto cosine_sign = hn::And(hn::ShiftLeft<62>(hn::Add(quarter, one)), top);
  *sine = hn::Xor(hn::IfThenElse(swap, c, s), hn::BitCast(d, sine_sign));
  *cosine = hn::Xor(hn::IfThenElse(swap, s, c), hn::BitCast(d, cosine_sign));
}

// Maps angles beyond the range of SinCos into the middle turn.
template <class D, class V = hn::Vec<D>>
HWY_NOINLINE V MiddleTurn(D d, V x) {
  HWY_ALIGN double lanes[HWY_MAX(hn::MaxLanes(d), 1)];
  hn::Store(x, d, lanes);
  for (double& angle : lanes) {
    if (!(std::abs(angle) < 1e5)) angle = std::atan2(std::sin(angle), std::cos(angle));
  }
  return hn::Load(d, lanes);
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE void SinCosOfAny(D d, V x, V* sine, V* cosine) {
  const auto near = hn::Lt(hn::Abs(x), hn::Set(d, 1e5));
  if (HWY_UNLIKELY(!hn::AllTrue(d, near))) x = MiddleTurn(d, x);
  SinCos(d, x, sine, cosine);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
