// Colours of what is seen; part of soft_kernel.cc, compiled for each instruction set.
#if defined(ROBOCELL_SOFT_SHADE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_SHADE_INL_H_
#undef ROBOCELL_SOFT_SHADE_INL_H_
#else
#define ROBOCELL_SOFT_SHADE_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_raster-inl.h"

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
HWY_INLINE V3 Unit(const V3& a) {
  return Times(hn::Div(Num(1), hn::Sqrt(hn::Max(Dot(a, a), Num(1e-30f)))), a);
}
// `rows` of `stride` numbers: their first three by the vector.
HWY_INLINE V3 Turned(const float* rows, int stride, const V3& v) {
  return {Dot(Set3(rows), v), Dot(Set3(rows + stride), v), Dot(Set3(rows + 2 * stride), v)};
}
HWY_INLINE V3 TurnedBack(const float* rows, int stride, const V3& v) {
  return Add(Add(Times(v.x, Set3(rows)), Times(v.y, Set3(rows + stride))),
             Times(v.z, Set3(rows + 2 * stride)));
}

// Of positive numbers; within 2e-5.
HWY_INLINE V Log2(V x) {
  const I bits = hn::BitCast(kInts, x);
  const V exponent = hn::ConvertTo(kFloats, hn::Sub(hn::ShiftRight<23>(bits), hn::Set(kInts, 127)));
  const V m = hn::BitCast(
      kFloats, hn::Or(hn::And(bits, hn::Set(kInts, 0x7fffff)), hn::Set(kInts, 0x3f800000)));
  const V t = hn::Div(hn::Sub(m, Num(1)), hn::Add(m, Num(1)));
  const V t2 = hn::Mul(t, t);
  V sum = hn::Add(hn::Mul(t2, Num(1.0f / 7)), Num(1.0f / 5));
  sum = hn::Add(hn::Mul(t2, sum), Num(1.0f / 3));
  sum = hn::Add(hn::Mul(t2, sum), Num(1));
  return hn::Add(exponent, hn::Mul(hn::Mul(t, Num(2.885390082f)), sum));
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
// The same within 2e-4 and without a division; for levels of textures.
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
// x to the power of e, for x from 0 to 1.
HWY_INLINE V Power(V x, float e) {
  if (e == 0) return Num(1);
  const V value = Exp2(hn::Mul(Num(e), Log2(hn::Max(x, Num(1e-30f)))));
  return hn::IfThenElseZero(hn::Gt(x, Num(1e-30f)), value);
}

// ---- Textures

HWY_INLINE Colour Unpack(I texel) {
  const I byte = hn::Set(kInts, 255);
  return {hn::ConvertTo(kFloats, hn::And(texel, byte)),
          hn::ConvertTo(kFloats, hn::And(hn::ShiftRight<8>(texel), byte)),
          hn::ConvertTo(kFloats, hn::And(hn::ShiftRight<16>(texel), byte))};
}
HWY_INLINE Colour Mix(const Colour& a, const Colour& b, V t) {
  const auto mix = [&](V from, V to)
                       HWY_ATTR { return hn::Add(from, hn::Mul(t, hn::Sub(to, from))); };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

// The texels at these places and those after them.
HWY_INLINE void Neighbours(const uint32_t* texels, I at, I* left, I* right) {
#if HWY_TARGET == HWY_SCALAR
  *left = hn::GatherIndex(kInts, reinterpret_cast<const int32_t*>(texels), at);
  *right = hn::GatherIndex(kInts, reinterpret_cast<const int32_t*>(texels) + 1, at);
#else
  constexpr hn::RepartitionToWide<Ints> pairs;
  constexpr hn::Half<Ints> half;
  const auto* from = reinterpret_cast<const int64_t*>(texels);
  const auto load = [&](auto some) HWY_ATTR {
    return hn::BitCast(kInts,
                       hn::GatherOffset(pairs, from, hn::ShiftLeft<2>(hn::PromoteTo(pairs, some))));
  };
  const I low = load(hn::LowerHalf(half, at)), high = load(hn::UpperHalf(half, at));
  *left = hn::ConcatEven(kInts, high, low);
  *right = hn::ConcatOdd(kInts, high, low);
#endif
}

// One level, between its four nearest texels; 0 ... 255. `face` is 0 for textures that are no cube.
HWY_INLINE Colour SampleLevel(const SoftTexture& texture, I level, I face, V u, V v) {
  I width, height, start;
  const auto first = static_cast<size_t>(hn::GetLane(level));
  if (hn::AllTrue(kInts, hn::Eq(level, hn::Set(kInts, static_cast<int32_t>(first))))) {
    width = hn::Set(kInts, texture.level_width[first]);
    height = hn::Set(kInts, texture.level_height[first]);
    start = hn::Set(kInts, texture.level_start[first]);
  } else {
    width = hn::GatherIndex(kInts, texture.level_width.data(), level);
    height = hn::GatherIndex(kInts, texture.level_height.data(), level);
    start = hn::GatherIndex(kInts, texture.level_start.data(), level);
  }
  const V w = hn::ConvertTo(kFloats, width), h = hn::ConvertTo(kFloats, height);
  const V zero = hn::Zero(kFloats), one = Num(1), half = Num(0.5f);
  V x, y, x0, y0, y1;
  if (texture.cube) {  // within the face
    x = hn::Min(hn::Max(hn::Sub(hn::Mul(u, w), half), zero), hn::Sub(w, one));
    y = hn::Min(hn::Max(hn::Sub(hn::Mul(v, h), half), zero), hn::Sub(h, one));
    x0 = hn::Floor(x);
    y0 = hn::Floor(y);
    y1 = hn::Min(hn::Add(y0, one), hn::Sub(h, one));
  } else {  // repeated
    x = hn::Sub(hn::Mul(hn::Sub(u, hn::Floor(u)), w), half);
    y = hn::Sub(hn::Mul(hn::Sub(v, hn::Floor(v)), h), half);
    x0 = hn::Floor(x);
    y0 = hn::Floor(y);
    y1 = hn::Add(y0, one);
  }
  const V fx = hn::Sub(x, x0), fy = hn::Sub(y, y0);
  if (!texture.cube) {
    x0 = hn::IfThenElse(hn::Lt(x0, zero), hn::Sub(w, one), hn::Min(x0, hn::Sub(w, one)));
    y0 = hn::IfThenElse(hn::Lt(y0, zero), hn::Sub(h, one), hn::Min(y0, hn::Sub(h, one)));
    y1 = hn::IfThenElse(hn::Ge(y1, h), zero, y1);
  }
  const I stride = hn::Add(width, hn::Set(kInts, 1));
  I corner = hn::Add(start, hn::ConvertTo(kInts, x0));
  if (texture.cube) corner = hn::Add(corner, hn::Mul(face, hn::Mul(stride, height)));
  Colour rows[2];
  for (int k = 0; k < 2; ++k) {
    const I at = hn::Add(corner, hn::Mul(hn::ConvertTo(kInts, k == 0 ? y0 : y1), stride));
    I left, right;
    Neighbours(texture.texels.data(), at, &left, &right);
    rows[k] = Mix(Unpack(left), Unpack(right), fx);
  }
  return Mix(rows[0], rows[1], fy);
}

// `square` is the square of a pixel's size in texels. 0 ... 1.
HWY_INLINE Colour Sample(const SoftTexture& texture, I face, V u, V v, V square) {
  const V most = Num(static_cast<float>(texture.levels - 1));
  const V lod = hn::Min(
      hn::Max(hn::Mul(Num(0.5f), RoughLog2(hn::Max(square, Num(1e-12f)))), hn::Zero(kFloats)),
      most);
  const V whole = hn::Floor(lod), rest = hn::Sub(lod, whole);
  const I level = hn::ConvertTo(kInts, whole);
  Colour c = SampleLevel(texture, level, face, u, v);
  if (!hn::AllFalse(kFloats, hn::Gt(rest, hn::Zero(kFloats)))) {
    const I next = hn::Min(hn::Add(level, hn::Set(kInts, 1)), hn::Set(kInts, texture.levels - 1));
    c = Mix(c, SampleLevel(texture, next, face, u, v), rest);
  }
  const V scale = Num(1.0f / 255);
  return {hn::Mul(c.r, scale), hn::Mul(c.g, scale), hn::Mul(c.b, scale)};
}

// `square`: of the change of the direction from pixel to pixel.
HWY_INLINE Colour SampleCube(const SoftTexture& texture, const V3& d, V square) {
  const V ax = hn::Abs(d.x), ay = hn::Abs(d.y), az = hn::Abs(d.z);
  const M is_x = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az));
  const M is_y = hn::AndNot(is_x, hn::Ge(ay, az));
  const auto pick = [&](V x, V y, V z)
                        HWY_ATTR { return hn::IfThenElse(is_x, x, hn::IfThenElse(is_y, y, z)); };
  const V major = hn::Max(pick(ax, ay, az), Num(1e-30f));
  const V sign = hn::CopySign(Num(1), pick(d.x, d.y, d.z));
  const V s = pick(hn::Neg(hn::Mul(sign, d.z)), d.x, hn::Mul(sign, d.x));
  const V t = pick(hn::Neg(d.y), hn::Mul(sign, d.z), hn::Neg(d.y));
  const V half = Num(0.5f), per = hn::Div(half, major);
  const V face = hn::Add(pick(hn::Zero(kFloats), Num(2), Num(4)),
                         hn::IfThenElseZero(hn::Lt(sign, hn::Zero(kFloats)), Num(1)));
  const V texels = hn::Mul(per, Num(static_cast<float>(texture.width)));
  return Sample(texture, hn::ConvertTo(kInts, face), hn::Add(hn::Mul(s, per), half),
                hn::Add(hn::Mul(t, per), half), hn::Mul(square, hn::Mul(texels, texels)));
}

// ---- Light

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

// ---- Surfaces

struct Pixels {
  V3 ray;  // in view axes, to depth 1; of orthographic cameras the offset on the image, and -1
  V depth;
  V3 at;  // view axes
};

// Through points that are this far from the pixels' centres.
HWY_INLINE Pixels PixelsAt(const SoftView& view, int bx, int by, int part, V nearness,
                           float right = 0, float down = 0) {
  const V u = hn::Add(Num(static_cast<float>(4 * bx)), hn::Load(kFloats, kColumn + part)),
          v = hn::Add(Num(static_cast<float>(4 * by)), hn::Load(kFloats, kRow + part));
  const V x = hn::Mul(hn::Sub(u, Num(view.cx - right)), Num(1 / view.fx)),
          y = hn::Mul(hn::Sub(Num(view.cy - down), v), Num(1 / view.fy));
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

// Changes of a position on a plane of this normal from pixel to pixel, in the mesh's axes.
HWY_INLINE void Changes(const SoftView& view, const float* m, const Pixels& p, const V3& normal,
                        V3* right, V3* down) {
  const V3 across = Times(Num(1 / view.fx), V3{Num(m[0]), Num(m[4]), Num(m[8])});
  const V3 along = Times(Num(-1 / view.fy), V3{Num(m[1]), Num(m[5]), Num(m[9])});
  V3 ray = V3{Num(-m[2]), Num(-m[6]), Num(-m[10])};
  if (!view.orthographic) ray = Turned(m, 4, p.ray);
  const V facing = Dot(normal, ray);
  const V steep = hn::Div(Num(1), hn::CopySign(hn::Max(hn::Abs(facing), Num(1e-20f)), facing));
  const auto change = [&](const V3& step) HWY_ATTR {
    return Times(view.orthographic ? Num(1) : p.depth,
                 Sub(step, Times(hn::Mul(Dot(normal, step), steep), ray)));
  };
  *right = change(across);
  *down = change(along);
}

HWY_INLINE V Square(V u, V v) { return hn::Add(hn::Mul(u, u), hn::Mul(v, v)); }

// The normal of a flat triangle in view axes: to the bit what the general way gives.
HWY_INLINE void FlatNormal(const float* m, const SoftSurface& surface, float* normal) {
  const auto part = [&](int k) {
    return static_cast<float>(static_cast<int16_t>(surface.normals[k / 2] >> (16 * (k % 2))));
  };
  const float n[3] = {part(0), part(1), part(2)};
  for (int k = 0; k < 3; ++k) normal[k] = (n[0] * m[k] + n[1] * m[4 + k]) + n[2] * m[8 + k];
  const float length2 = (normal[0] * normal[0] + normal[1] * normal[1]) + normal[2] * normal[2];
  const float scale = 1 / std::sqrt(std::max(length2, 1e-30f));
  for (int k = 0; k < 3; ++k) normal[k] = scale * normal[k];
}

// kOne: all pixels show triangle `one`; otherwise `triangle` says which.
template <bool kOne>
HWY_INLINE Colour ShadeInstance(const SoftPicture& picture, const SoftInstance& instance,
                                const Pixels& p, int one, I triangle) {
  const SoftMesh& mesh = *instance.mesh;
  const SoftSurface& only = mesh.surface[kOne ? one : 0];
  const auto* words = reinterpret_cast<const int32_t*>(mesh.surface.data());
  const I index = hn::ShiftLeft<4>(triangle);
  static_assert(sizeof(SoftSurface) == 64);
  const auto word = [&](int k) HWY_ATTR {
    if constexpr (kOne) {
      return hn::Set(kInts, words[16 * one + k]);
    } else {
      return hn::GatherIndex(kInts, words + k, index);
    }
  };
  const auto number = [&](int k) HWY_ATTR { return hn::BitCast(kFloats, word(k)); };
  const float* m = instance.to_mesh;
  V3 at = Turned(m, 4, p.at);
  at = {hn::Add(at.x, Num(m[3])), hn::Add(at.y, Num(m[7])), hn::Add(at.z, Num(m[11]))};
  const V3 to1 = {number(0), number(1), number(2)}, to2 = {number(4), number(5), number(6)};
  const V w1 = Clamp01(hn::Sub(Dot(at, to1), number(3))),
          w2 = Clamp01(hn::Sub(Dot(at, to2), number(7)));
  V3 normal;
  if (kOne && only.flat) {
    float flat[3];
    FlatNormal(m, only, flat);
    normal = Set3(flat);
  } else {
    V n[10];
    for (int k = 0; k < 5; ++k) {
      const I both = word(8 + k);
      n[2 * k] = hn::ConvertTo(kFloats, hn::ShiftRight<16>(hn::ShiftLeft<16>(both)));
      n[2 * k + 1] = hn::ConvertTo(kFloats, hn::ShiftRight<16>(both));
    }
    const auto between = [&](int k) HWY_ATTR {
      return hn::Add(n[k], hn::Add(hn::Mul(w1, hn::Sub(n[3 + k], n[k])),
                                   hn::Mul(w2, hn::Sub(n[6 + k], n[k]))));
    };
    normal = Unit(TurnedBack(m, 4, {between(0), between(1), between(2)}));
  }
  const SoftMaterial& material = instance.material;
  Colour c = Light(picture, material, p.at, normal);
  if (material.mapping == SoftMapping::kNone) return c;

  const SoftTexture& texture = *material.texture;
  V3 right, down;
  Changes(*picture.view, m, p, Cross(to1, to2), &right, &down);
  Colour texel;
  if (material.mapping == SoftMapping::kCube) {
    const V3 scale = Set3(material.scale);
    const auto scaled = [&](const V3& v) HWY_ATTR {
      return V3{hn::Mul(v.x, scale.x), hn::Mul(v.y, scale.y), hn::Mul(v.z, scale.z)};
    };
    const V3 r = scaled(right), d = scaled(down);
    texel = SampleCube(texture, scaled(at), hn::Max(Dot(r, r), Dot(d, d)));
  } else {
    V u, v, ur, vr, ud, vd;
    if (material.mapping == SoftMapping::kPlanar) {
      const V su = Num(material.scale[0]), sv = Num(material.scale[1]);
      u = hn::Add(hn::Mul(su, at.x), Num(material.offset[0]));
      v = hn::Add(hn::Mul(sv, at.y), Num(material.offset[1]));
      ur = hn::Mul(su, right.x);
      vr = hn::Mul(sv, right.y);
      ud = hn::Mul(su, down.x);
      vd = hn::Mul(sv, down.y);
    } else {
      const float* coordinates = mesh.texture.data();
      const I place = hn::Mul(triangle, hn::Set(kInts, SoftMesh::kTexture));
      const auto coordinate = [&](int k) HWY_ATTR {
        if constexpr (kOne) {
          return Num(coordinates[SoftMesh::kTexture * one + k]);
        } else {
          return hn::GatherIndex(kFloats, coordinates + k, place);
        }
      };
      const V u1 = coordinate(2), v1 = coordinate(3), u2 = coordinate(4), v2 = coordinate(5);
      const auto mix = [&](V a, V b, V first, V second)
                           HWY_ATTR { return hn::Add(hn::Mul(a, first), hn::Mul(b, second)); };
      u = hn::Add(coordinate(0), mix(w1, w2, u1, u2));
      v = hn::Add(coordinate(1), mix(w1, w2, v1, v2));
      const V r1 = Dot(to1, right), r2 = Dot(to2, right), d1 = Dot(to1, down), d2 = Dot(to2, down);
      ur = mix(r1, r2, u1, u2);
      vr = mix(r1, r2, v1, v2);
      ud = mix(d1, d2, u1, u2);
      vd = mix(d1, d2, v1, v2);
    }
    const V w = Num(static_cast<float>(texture.width)), h = Num(static_cast<float>(texture.height));
    const V square =
        hn::Max(Square(hn::Mul(ur, w), hn::Mul(vr, h)), Square(hn::Mul(ud, w), hn::Mul(vd, h)));
    texel = Sample(texture, hn::Zero(kInts), u, v, square);
  }
  return {hn::Mul(c.r, texel.r), hn::Mul(c.g, texel.g), hn::Mul(c.b, texel.b)};
}

// ---- Sky

HWY_INLINE Colour SkyColour(const SoftPicture& picture, const V3& in_world) {
  if (!picture.sky.texture) {
    const V zero = hn::Zero(kFloats);
    return {zero, zero, zero};
  }
  // A pixel's change of direction, at the centre of the image.
  const float step = picture.view->orthographic ? 0 : 1 / picture.view->fx;
  // The texture's y axis is up.
  return SampleCube(*picture.sky.texture, {in_world.x, in_world.z, hn::Neg(in_world.y)},
                    Num(step * step));
}

// Sky and haze hide what is beyond them. `nothing`: pixels that show no surface.
HWY_INLINE Colour WithSky(const SoftPicture& picture, const Pixels& p, M nothing, Colour c) {
  const SoftSky& sky = picture.sky;
  if (!sky.texture) {
    const V zero = hn::Zero(kFloats);
    return {hn::IfThenElse(nothing, zero, c.r), hn::IfThenElse(nothing, zero, c.g),
            hn::IfThenElse(nothing, zero, c.b)};
  }
  const V3 ray =
      picture.view->orthographic ? V3{hn::Zero(kFloats), hn::Zero(kFloats), Num(-1)} : p.ray;
  // Nothing that is near enough is hidden.
  const float haze_begins = sky.elevation > 0 ? 1 - sky.haze : 1;
  const V within = Num(0.7f * haze_begins * sky.radius);
  const V length2 = hn::Mul(hn::Mul(p.depth, p.depth), Dot(ray, ray));
  const M may_be = hn::Or(nothing, hn::Gt(length2, hn::Mul(within, within)));
  if (hn::AllFalse(kFloats, may_be)) return c;

  const V3 in_world = Turned(sky.from_view, 3, ray);
  const V flat = hn::Sqrt(Square(in_world.x, in_world.y));
  const V extent = hn::Max(hn::Max(flat, hn::Abs(in_world.z)), Num(1e-20f));
  const M behind = hn::Or(nothing, hn::Gt(hn::Mul(p.depth, extent), Num(sky.radius)));
  if (!hn::AllFalse(kFloats, behind)) {
    const Colour s = SkyColour(picture, in_world);
    c = {hn::IfThenElse(behind, s.r, c.r), hn::IfThenElse(behind, s.g, c.g),
         hn::IfThenElse(behind, s.b, c.b)};
  }
  if (sky.elevation <= 0) return c;

  // The haze is a cone that rises from the plane to the height of the camera at the sky.
  const V3 to = Turned(sky.to_plane, 3, ray);
  const V zero = hn::Zero(kFloats), one = Num(1), r = Num(sky.haze);
  const V along = hn::Max(hn::Sqrt(Square(to.x, to.y)), Num(1e-20f));
  const V slope = hn::Div(to.z, along);
  const V below =
      hn::Div(hn::Neg(slope),
              hn::Max(hn::Sub(Num(sky.elevation / sky.radius), hn::Mul(slope, r)), Num(1e-20f)));
  const V height = hn::Sub(one, below);
  const V distance = hn::Mul(Num(sky.radius), hn::Sub(one, hn::Mul(r, below)));
  const M hazy = hn::And(hn::And(hn::Ge(below, zero), hn::Le(below, one)),
                         hn::Or(behind, hn::Gt(hn::Mul(p.depth, along), distance)));
  const V densest = Num(sky.haze_height);
  const V rising = hn::Div(height, densest),
          falling = hn::Div(hn::Sub(one, height), hn::Sub(one, densest));
  const V alpha = hn::IfThenElseZero(hazy, Clamp01(hn::Min(rising, falling)));
  return Mix(c, {Num(sky.haze_rgb[0]), Num(sky.haze_rgb[1]), Num(sky.haze_rgb[2])}, alpha);
}

// ---- Blocks

HWY_INLINE I PackPixels(const Colour& c) {
  const V scale = Num(255);
  const auto byte = [&](V v) HWY_ATTR { return hn::NearestInt(hn::Mul(Clamp01(v), scale)); };
  return hn::Or(byte(c.r), hn::Or(hn::ShiftLeft<8>(byte(c.g)), hn::ShiftLeft<16>(byte(c.b))));
}

// Colours of a register of pixels; black where nothing is.
HWY_INLINE Colour ShadePixels(const SoftPicture& picture, const Pixels& p, I ids) {
  const V zero = hn::Zero(kFloats);
  Colour c{zero, zero, zero};
  alignas(64) int32_t all[kSoftPixels];
  hn::Store(ids, kInts, all);
  for (int k = 0; k < kLanes; ++k) {
    if (all[k] < 0) continue;
    const SoftInstance& instance =
        picture.instances[picture.instance_of_run[all[k] >> kSoftRunBits]];
    const auto first = static_cast<int32_t>(instance.first_id);
    const I one = hn::Set(kInts, all[k]);
    if (hn::AllTrue(kInts, hn::Eq(ids, one))) {
      return ShadeInstance<true>(picture, instance, p, all[k] - first, one);
    }
    const I triangle = hn::Sub(ids, hn::Set(kInts, first));
    const auto of_this = hn::And(hn::Gt(triangle, hn::Set(kInts, -1)),
                                 hn::Lt(triangle, hn::Set(kInts, instance.mesh->triangles)));
    const Colour here =
        ShadeInstance<false>(picture, instance, p, 0, hn::IfThenElseZero(of_this, triangle));
    const M mask = hn::RebindMask(kFloats, of_this);
    c = {hn::IfThenElse(mask, here.r, c.r), hn::IfThenElse(mask, here.g, c.g),
         hn::IfThenElse(mask, here.b, c.b)};
    for (int later = k; later < kLanes; ++later) {  // done
      const int32_t offset = all[later] - first;
      if (offset >= 0 && offset < instance.mesh->triangles) all[later] = -1;
    }
  }
  return c;
}

HWY_INLINE I LoadIds(const SoftBuffer& buffer, size_t block, int part) {
  return hn::Load(kInts, reinterpret_cast<const int32_t*>(buffer.ids[block].at) + part);
}
HWY_INLINE V LoadNearness(const SoftBuffer& buffer, size_t block, int part) {
  return hn::Load(kFloats, buffer.nearness[block].at + part);
}

// The mean over the samples of pixels whose centres have colour `c`. A sample of the same surface
// has that colour too: edges are smoothed, textures and highlights are not.
HWY_INLINE Colour WithSamples(const SoftPicture& picture, std::span<const SoftSample> samples,
                              size_t block, int bx, int by, int part, I ids, V nearness,
                              const Colour& c) {
  const V zero = hn::Zero(kFloats);
  const V close = hn::Mul(Num(0.02f), nearness);
  const I run = hn::ShiftRight<kSoftRunBits>(ids);
  Colour sum{zero, zero, zero};
  bool edge = false;
  for (const SoftSample& sample : samples) {
    const I at = LoadIds(sample.buffer, block, part);
    const V near = LoadNearness(sample.buffer, block, part);
    const M same = hn::And(hn::RebindMask(kFloats, hn::Eq(run, hn::ShiftRight<kSoftRunBits>(at))),
                           hn::Le(hn::Abs(hn::Sub(near, nearness)), close));
    Colour here = c;
    if (!hn::AllTrue(kFloats, same)) {
      edge = true;
      const Pixels p = PixelsAt(*picture.view, bx, by, part, near, sample.right, sample.down);
      const I other = hn::IfThenElse(hn::RebindMask(kInts, same), hn::Set(kInts, -1), at);
      const M nothing = hn::RebindMask(kFloats, hn::Lt(other, hn::Zero(kInts)));
      const Colour shaded = WithSky(picture, p, nothing, ShadePixels(picture, p, other));
      here = {hn::IfThenElse(same, c.r, Clamp01(shaded.r)),
              hn::IfThenElse(same, c.g, Clamp01(shaded.g)),
              hn::IfThenElse(same, c.b, Clamp01(shaded.b))};
    }
    sum = {hn::Add(sum.r, here.r), hn::Add(sum.g, here.g), hn::Add(sum.b, here.b)};
  }
  if (!edge) return c;
  const V share = Num(1 / static_cast<float>(samples.size()));
  return {hn::Mul(share, sum.r), hn::Mul(share, sum.g), hn::Mul(share, sum.b)};
}

inline void ShadePictureHere(const SoftPicture& picture, const SoftBuffer& buffer,
                             std::span<const SoftSample> samples, SoftIds* colours) {
  for (int by = 0; by < buffer.rows; ++by) {
    for (int bx = 0; bx < buffer.columns; ++bx) {
      const size_t block = static_cast<size_t>(by) * buffer.columns + bx;
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        const I ids = LoadIds(buffer, block, part);
        const V nearness = LoadNearness(buffer, block, part);
        const Pixels p = PixelsAt(*picture.view, bx, by, part, nearness);
        const M nothing = hn::RebindMask(kFloats, hn::Lt(ids, hn::Zero(kInts)));
        Colour c = WithSky(picture, p, nothing, ShadePixels(picture, p, ids));
        c = {Clamp01(c.r), Clamp01(c.g), Clamp01(c.b)};
        if (!samples.empty()) {
          c = WithSamples(picture, samples, block, bx, by, part, ids, nearness, c);
        }
        hn::Store(PackPixels(c), kInts, reinterpret_cast<int32_t*>(colours[block].at) + part);
      }
    }
  }
}

inline void ReadExactHere(const SoftPicture& picture, const SoftBuffer& buffer, float* metres,
                          int32_t* bodies) {
  const SoftView& view = *picture.view;
  for (int by = 0; by < buffer.rows; ++by) {
    const int rows = std::min(kSoftBlock, view.height - kSoftBlock * by);
    for (int bx = 0; bx < buffer.columns; ++bx) {
      const size_t block = static_cast<size_t>(by) * buffer.columns + bx;
      const int columns = std::min(kSoftBlock, view.width - kSoftBlock * bx);
      const size_t first = static_cast<size_t>(kSoftBlock * by) * view.width + kSoftBlock * bx;
      const uint32_t* ids = buffer.ids[block].at;
      if (metres) {
        alignas(64) float depth[kSoftPixels];
        for (int part = 0; part < kSoftPixels; part += kLanes) {
          const V q = hn::Load(kFloats, buffer.nearness[block].at + part);
          const I id = hn::Load(kInts, reinterpret_cast<const int32_t*>(ids) + part);
          const V d = view.orthographic
                          ? hn::Sub(Num(view.far), hn::Mul(q, Num(view.far - view.near)))
                          : hn::Div(Num(1), q);
          const M seen = hn::RebindMask(kFloats, hn::Gt(id, hn::Set(kInts, -1)));
          hn::Store(hn::IfThenElseZero(seen, d), kFloats, depth + part);
        }
        for (int r = 0; r < rows; ++r) {
          std::copy_n(depth + kSoftBlock * r, columns,
                      metres + first + static_cast<size_t>(r) * view.width);
        }
      }
      if (bodies) {
        // Nearly all blocks show one body.
        uint32_t run = ids[0] >> kSoftRunBits, others = 0;
        for (int k = 1; k < kSoftPixels; ++k) others |= ids[k] >> kSoftRunBits ^ run;
        int32_t body =
            ids[0] == kSoftNothing ? -1 : picture.instances[picture.instance_of_run[run]].body;
        if (others == 0) {
          for (int r = 0; r < rows; ++r) {
            std::fill_n(bodies + first + static_cast<size_t>(r) * view.width, columns, body);
          }
          continue;
        }
        for (int r = 0; r < rows; ++r) {
          int32_t* to = bodies + first + static_cast<size_t>(r) * view.width;
          for (int c = 0; c < columns; ++c) {
            const uint32_t id = ids[kSoftBlock * r + c];
            if (id == kSoftNothing) {
              to[c] = -1;
              continue;
            }
            if (id >> kSoftRunBits != run) {
              run = id >> kSoftRunBits;
              body = picture.instances[picture.instance_of_run[run]].body;
            }
            to[c] = body;
          }
        }
      }
    }
  }
}

inline void BlendLayerHere(const SoftPicture& picture, const SoftBuffer& behind,
                           const SoftBuffer& layer, float alpha, SoftIds* colours) {
  for (int by = 0; by < layer.rows; ++by) {
    for (int bx = 0; bx < layer.columns; ++bx) {
      const size_t block = static_cast<size_t>(by) * layer.columns + bx;
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        I ids = hn::Load(kInts, reinterpret_cast<const int32_t*>(layer.ids[block].at) + part);
        const V nearness = hn::Load(kFloats, layer.nearness[block].at + part);
        const M seen =
            hn::And(hn::RebindMask(kFloats, hn::Gt(ids, hn::Set(kInts, -1))),
                    hn::Ge(nearness, hn::Load(kFloats, behind.nearness[block].at + part)));
        if (hn::AllFalse(kFloats, seen)) continue;
        ids = hn::IfThenElse(hn::RebindMask(kInts, seen), ids, hn::Set(kInts, -1));
        const Pixels p = PixelsAt(*picture.view, bx, by, part, nearness);
        auto* at = reinterpret_cast<int32_t*>(colours[block].at) + part;
        const Colour under = Unpack(hn::Load(kInts, at));
        const V scale = Num(1.0f / 255);
        const Colour before{hn::Mul(under.r, scale), hn::Mul(under.g, scale),
                            hn::Mul(under.b, scale)};
        const Colour after =
            Mix(before, ShadePixels(picture, p, ids), hn::IfThenElseZero(seen, Num(alpha)));
        hn::Store(PackPixels(after), kInts, at);
      }
    }
  }
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
