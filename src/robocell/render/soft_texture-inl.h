// Colours of textures; part of soft_kernel.cc, compiled for each instruction set.
#if defined(ROBOCELL_SOFT_TEXTURE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_TEXTURE_INL_H_
#undef ROBOCELL_SOFT_TEXTURE_INL_H_
#else
#define ROBOCELL_SOFT_TEXTURE_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>

#include "robocell/render/soft_texture.h"
#include "robocell/render/soft_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

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

// Loads the texels at these places and those after them.
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

// Samples one level between its four nearest texels; 0 ... 255. `face` is 0 for textures other than
// cubes.
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
  const auto at = [&](V row) HWY_ATTR {
    return hn::Add(corner, hn::Mul(hn::ConvertTo(kInts, row), stride));
  };
  const uint32_t* texels = texture.texels.data();
  const I at0 = at(y0);
  // Inside an area of one colour, as in most of a checker.
  const I plain = hn::GatherIndex(kInts, reinterpret_cast<const int32_t*>(texels), at0);
  if (hn::AllTrue(kInts, hn::Gt(plain, hn::Set(kInts, 0xffffff)))) return Unpack(plain);
  I left0, right0, left1, right1;
  Neighbours(texels, at0, &left0, &right0);
  Neighbours(texels, at(y1), &left1, &right1);
  return Mix(Mix(Unpack(left0), Unpack(right0), fx), Mix(Unpack(left1), Unpack(right1), fx), fy);
}

// Finds where a level has one colour between the places `low` and `high` of a texture that repeats:
// sampling any place there gives the texel that is returned, bit by bit.
struct PlaceRange {
  V low, high;
};
HWY_INLINE M FindWide(const SoftTexture& texture, I level, const PlaceRange& u, const PlaceRange& v,
                      I* texel) {
  const V w = hn::ConvertTo(kFloats, hn::GatherIndex(kInts, texture.level_width.data(), level)),
          h = hn::ConvertTo(kFloats, hn::GatherIndex(kInts, texture.level_height.data(), level));
  const I start = hn::GatherIndex(kInts, texture.level_start.data(), level);
  // Places are rounded: by less than a quarter of a texel if they are not too far out.
  const V farthest = Num(1 << 17), margin = Num(0.25f), half = Num(0.5f), zero = hn::Zero(kFloats);
  const auto first_of = [&](const PlaceRange& p, V size, M* wide, M* wider) HWY_ATTR {
    const V repeats = hn::Floor(p.low);
    const V first =
                hn::Floor(hn::Sub(hn::Mul(hn::Sub(p.low, repeats), size), hn::Add(half, margin))),
            last =
                hn::Floor(hn::Sub(hn::Mul(hn::Sub(p.high, repeats), size), hn::Sub(half, margin)));
    const V reach = hn::Mul(hn::Max(hn::Abs(p.low), hn::Abs(p.high)), size);
    const V extent = hn::Sub(last, first);  // and one texel that is mixed in
    const M near = hn::Lt(reach, farthest);
    *wide = hn::And(near, hn::Le(extent, Num(kSoftWideSide - 2)));
    *wider = hn::And(near, hn::Le(extent, Num(kSoftWiderSide - 2)));
    const V wrapped = hn::IfThenElse(hn::Lt(first, zero), hn::Add(first, size), first);
    return hn::Max(hn::Min(wrapped, hn::Sub(size, Num(1))), zero);
  };
  M wide_u, wide_v, wider_u, wider_v;
  const V x = first_of(u, w, &wide_u, &wider_u), y = first_of(v, h, &wide_v, &wider_v);
  const M wide = hn::And(wide_u, wide_v), wider = hn::And(wider_u, wider_v);
  const I row = hn::ConvertTo(kInts, hn::IfThenElseZero(wider, y)),
          column = hn::ConvertTo(kInts, hn::IfThenElseZero(wider, x));
  const I stride = hn::Add(hn::ConvertTo(kInts, w), hn::Set(kInts, 1));
  *texel = hn::GatherIndex(kInts, reinterpret_cast<const int32_t*>(texture.texels.data()),
                           hn::Add(start, hn::Add(hn::Mul(row, stride), column)));
  const auto is_marked = [&](uint32_t with) HWY_ATTR {
    const I mark = hn::Set(kInts, static_cast<int32_t>(with));
    return hn::RebindMask(kFloats, hn::Eq(hn::And(*texel, mark), mark));
  };
  return hn::Or(hn::And(wide, is_marked(kSoftWide)), hn::And(wider, is_marked(kSoftWider)));
}

// The level that shows a pixel as one texel, and a fraction. `square` is the square of a pixel's
// size in texels of the largest level.
HWY_INLINE V LevelOf(const SoftTexture& texture, V square) {
  const V most = Num(static_cast<float>(texture.levels - 1));
  return hn::Min(
      hn::Max(hn::Mul(Num(0.5f), RoughLog2(hn::Max(square, Num(1e-12f)))), hn::Zero(kFloats)),
      most);
}

HWY_INLINE Colour Share255(const Colour& c) {
  const V scale = Num(1.0f / 255);
  return {hn::Mul(c.r, scale), hn::Mul(c.g, scale), hn::Mul(c.b, scale)};
}

// 0 ... 1, between one level and the next.
HWY_INLINE Colour Sample(const SoftTexture& texture, int level, float rest, V u, V v) {
  const I none = hn::Zero(kInts);
  const Colour c = SampleLevel(texture, hn::Set(kInts, level), none, u, v);
  if (rest <= 0) return Share255(c);
  const int next = level + 1 < texture.levels ? level + 1 : level;
  return Share255(Mix(c, SampleLevel(texture, hn::Set(kInts, next), none, u, v), Num(rest)));
}

// Samples with levels that may differ. `square` as above.
HWY_INLINE Colour Sample(const SoftTexture& texture, I face, V u, V v, V square) {
  const V lod = LevelOf(texture, square);
  const V whole = hn::Floor(lod), rest = hn::Sub(lod, whole);
  const I level = hn::ConvertTo(kInts, whole);
  Colour c = SampleLevel(texture, level, face, u, v);
  if (!hn::AllFalse(kFloats, hn::Gt(rest, hn::Zero(kFloats)))) {
    const I next = hn::Min(hn::Add(level, hn::Set(kInts, 1)), hn::Set(kInts, texture.levels - 1));
    c = Mix(c, SampleLevel(texture, next, face, u, v), rest);
  }
  return Share255(c);
}

// `square`: that of the change of the direction from pixel to pixel.
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

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
