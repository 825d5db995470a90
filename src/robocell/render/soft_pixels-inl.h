// Positions of the surfaces in pixels; part of soft_kernel.cc, compiled for each instruction set.
#if defined(ROBOCELL_SOFT_PIXELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_PIXELS_INL_H_
#undef ROBOCELL_SOFT_PIXELS_INL_H_
#else
#define ROBOCELL_SOFT_PIXELS_INL_H_
#endif

#include <hwy/highway.h>

#include "robocell/render/soft_blocks-inl.h"
#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

struct Pixels {
  V3 ray;  // ray in view axes, to depth 1; orthographic: offset on the image, and -1
  V depth;
  V3 at;  // view axes
};

// Returns the pixels at these places of the image.
HWY_INLINE Pixels PixelsThrough(const SoftView& view, V u, V v, V nearness) {
  const V x = hn::Mul(hn::Sub(u, Num(view.cx)), Num(view.per_fx)),
          y = hn::Mul(hn::Sub(Num(view.cy), v), Num(view.per_fy));
  Pixels p{{x, y, Num(-1)}, Num(1), {}};
  if (view.orthographic) {
    p.depth = hn::Sub(Num(view.far), hn::Mul(nearness, Num(view.far - view.near)));
    p.at = {x, y, hn::Neg(p.depth)};
  } else {
    p.depth = hn::Div(Num(1), hn::Max(nearness, Num(1e-30f)));
    p.at = Times(p.depth, p.ray);
  }
  return p;
}

HWY_INLINE Pixels PixelsAt(const SoftView& view, int bx, int by, int part, V nearness) {
  const V u = hn::Add(Num(static_cast<float>(4 * bx)), hn::Load(kFloats, kColumn + part)),
          v = hn::Add(Num(static_cast<float>(4 * by)), hn::Load(kFloats, kRow + part));
  return PixelsThrough(view, u, v, nearness);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
