// Light and shadow on surfaces; part of soft_kernel.cc, compiled for each instruction set.
#if defined(ROBOCELL_SOFT_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_LIGHT_INL_H_
#undef ROBOCELL_SOFT_LIGHT_INL_H_
#else
#define ROBOCELL_SOFT_LIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

// Share of a light that reaches points, with a soft edge of two pixels of the map. `facing` is the
// cosine between normal and light.
HWY_INLINE V Lit(const SoftShadow& shadow, const V3& at, const V3& normal, V facing) {
  const V zero = hn::Zero(kFloats), one = Num(1), half = Num(0.5f);
  const M towards = hn::Gt(facing, zero);
  if (hn::AllFalse(kFloats, towards)) return zero;
  const SoftView& view = shadow.view;
  const float* m = shadow.from_view;
  const auto depth_of = [&](const V3& p)
                            HWY_ATTR { return hn::Neg(hn::Add(Dot(Set3(m + 8), p), Num(m[11]))); };
  // Surfaces are rounded to the map's pixels: points are lifted off by a share of one, by more
  // where light grazes.
  const V slant = hn::Sqrt(hn::Max(hn::Sub(one, hn::Mul(facing, facing)), zero));
  V pixel = Num(1 / view.fx);
  if (!view.orthographic) pixel = hn::Mul(pixel, hn::Max(depth_of(at), zero));
  const V lift = hn::Mul(pixel, hn::Add(Num(0.7f), hn::Mul(Num(1.8f), slant)));
  const V3 p = Add(at, Times(lift, normal));
  const V depth = depth_of(p);
  const V shrink = view.orthographic ? one : hn::Div(one, hn::Max(depth, Num(1e-6f)));
  const V nearness = view.orthographic
                         ? hn::Mul(hn::Sub(Num(view.far), depth), Num(1 / (view.far - view.near)))
                         : shrink;
  const V x = hn::Add(Dot(Set3(m), p), Num(m[3])), y = hn::Add(Dot(Set3(m + 4), p), Num(m[7]));
  const V u = hn::Sub(hn::Add(hn::Mul(hn::Mul(Num(view.fx), x), shrink), Num(view.cx)), half),
          v = hn::Sub(hn::Sub(Num(view.cy), hn::Mul(hn::Mul(Num(view.fy), y), shrink)), half);
  const V last = Num(static_cast<float>(view.width - 4));
  // What the map does not show is lit.
  const M inside = hn::And(
      hn::And(towards, hn::Gt(depth, Num(view.near))),
      hn::And(hn::And(hn::Gt(u, one), hn::Lt(u, last)), hn::And(hn::Gt(v, one), hn::Lt(v, last))));
  if (hn::AllFalse(kFloats, inside)) return one;
  const V us = hn::IfThenElseZero(inside, u), vs = hn::IfThenElseZero(inside, v);
  const V u0 = hn::Floor(us), v0 = hn::Floor(vs);
  const V fu = hn::Sub(us, u0), fv = hn::Sub(vs, v0);
  const V across[3] = {hn::Sub(one, fu), one, fu}, along[3] = {hn::Sub(one, fv), one, fv};
  const I column = hn::ConvertTo(kInts, u0), row = hn::ConvertTo(kInts, v0);
  const I three = hn::Set(kInts, 3);
  const float* map = shadow.map->nearness[0].at;
  I columns[3];
  for (int k = 0; k < 3; ++k) {
    const I c = hn::Add(column, hn::Set(kInts, k));
    columns[k] = hn::Add(hn::ShiftLeft<4>(hn::ShiftRight<2>(c)), hn::And(c, three));
  }
  V sum = zero;
  for (int j = 0; j < 3; ++j) {
    const I r = hn::Add(row, hn::Set(kInts, j));
    const I start =
        hn::Add(hn::Mul(hn::ShiftRight<2>(r), hn::Set(kInts, kSoftPixels * shadow.map->columns)),
                hn::ShiftLeft<2>(hn::And(r, three)));
    V of_row = zero;
    for (int k = 0; k < 3; ++k) {
      const V first = hn::GatherIndex(kFloats, map, hn::Add(start, columns[k]));
      of_row = hn::Add(of_row, hn::IfThenElseZero(hn::Ge(nearness, first), across[k]));
    }
    sum = hn::Add(sum, hn::Mul(along[j], of_row));
  }
  return hn::IfThenElse(inside, hn::Mul(sum, Num(0.25f)), one);
}

// Adds the mirror image of the light. `middle`: between the directions to the light and back.
HWY_INLINE void AddHighlight(const SoftMaterial& material, const SoftLight& light, V strength,
                             const V3& normal, V facing, const V3& middle, V* to) {
  // Most pixels are far from the highlight; what is left out is less than half a step of colour.
  const V zero = hn::Zero(kFloats);
  const V along = Dot(normal, middle), length2 = Dot(middle, middle);
  const M bright =
      hn::And(hn::And(hn::Gt(facing, zero), hn::Gt(along, zero)),
              hn::Ge(hn::Mul(along, along), hn::Mul(Num(material.least_shine), length2)));
  if (hn::AllFalse(kFloats, bright)) return;
  const V shine = hn::Div(along, hn::Sqrt(hn::Max(length2, Num(1e-30f))));
  const V highlight =
      hn::IfThenElseZero(bright, hn::Mul(hn::Mul(strength, Num(material.specular)),
                                         Power(Clamp01(shine), material.shininess)));
  for (int c = 0; c < 3; ++c) {
    to[c] = hn::Add(to[c], hn::Mul(highlight, Num(light.specular[c])));
  }
}

HWY_INLINE Colour Light(const SoftPicture& picture, const SoftMaterial& material, const V3& at,
                        const V3& normal) {
  const V base[3] = {Num(material.rgba[0]), Num(material.rgba[1]), Num(material.rgba[2])};
  const V own = Num(material.emission + picture.ambient);
  V sum[3] = {hn::Mul(own, base[0]), hn::Mul(own, base[1]), hn::Mul(own, base[2])};
  // The engine adds each light that casts shadows in a picture of its own.
  V added[3] = {hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};
  V3 back{};
  if (material.shines) back = Unit({hn::Neg(at.x), hn::Neg(at.y), hn::Neg(at.z)});
  const V zero = hn::Zero(kFloats);
  for (int l = 0; l < picture.light_count; ++l) {
    const SoftLight& light = picture.lights[l];
    V3 to = Set3(light.direction);
    V strength = Num(1);
    if (!light.directional) {
      const V3 offset = Sub(Set3(light.position), at);
      const V distance = hn::Sqrt(hn::Max(Dot(offset, offset), Num(1e-30f)));
      to = Times(hn::Div(Num(1), distance), offset);
      const V fade =
          hn::Add(Num(light.attenuation[0]),
                  hn::Mul(distance, hn::Add(Num(light.attenuation[1]),
                                            hn::Mul(distance, Num(light.attenuation[2])))));
      strength = hn::Div(Num(1), fade);
      if (light.cutoff_cosine > -1) {
        const V off = hn::Neg(Dot(to, Set3(light.direction)));
        const V beam = Power(Clamp01(off), light.exponent);
        strength =
            hn::IfThenElseZero(hn::Ge(off, Num(light.cutoff_cosine)), hn::Mul(strength, beam));
      }
    }
    const V facing = Dot(normal, to);
    const bool shadowed = picture.shadows && light.shadow;
    if (shadowed) strength = hn::Mul(strength, Lit(*light.shadow, at, normal, facing));
    const V diffuse = hn::Mul(strength, hn::Max(facing, zero));
    V from[3];
    for (int c = 0; c < 3; ++c) {
      const V reflected = hn::Add(hn::Mul(strength, Num(light.ambient[c])),
                                  hn::Mul(diffuse, Num(light.diffuse[c])));
      from[c] = hn::Mul(reflected, base[c]);
    }
    if (material.shines && light.shines)
      AddHighlight(material, light, strength, normal, facing, Add(to, back), from);
    for (int c = 0; c < 3; ++c) {
      if (shadowed) {
        added[c] = hn::Add(added[c], Clamp01(from[c]));
      } else {
        sum[c] = hn::Add(sum[c], from[c]);
      }
    }
  }
  return {hn::Add(Clamp01(sum[0]), added[0]), hn::Add(Clamp01(sum[1]), added[1]),
          hn::Add(Clamp01(sum[2]), added[2])};
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
