// Shadow maps: which share of a light reaches points; part of soft_kernel.cc, compiled for each
// instruction set.
#if defined(ROBOCELL_SOFT_SHADOW_MAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_SHADOW_MAP_INL_H_
#undef ROBOCELL_SOFT_SHADOW_MAP_INL_H_
#else
#define ROBOCELL_SOFT_SHADOW_MAP_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>

#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

// What is nearest and farthest in each tile that something may have been drawn in. A tile's numbers
// are those of all pixels that points in it look at: one row and one column of blocks more.
inline void SummariseMapHere(SoftShadowMap* map) {
  const SoftBuffer& buffer = map->buffer;
  const int tile_rows = map->tile_rows, tile_columns = map->tile_columns;
  const auto drawn = [&](int x, int y) {
    return x < tile_columns && y < tile_rows && map->drawn[y * tile_columns + x] != 0;
  };
  for (int y = 0; y < tile_rows; ++y) {
    for (int x = 0; x < tile_columns; ++x) {
      const int tile = y * tile_columns + x;
      map->nearest[tile] = map->farthest[tile] = map->background;
      if (!drawn(x, y) && !drawn(x + 1, y) && !drawn(x, y + 1) && !drawn(x + 1, y + 1)) continue;
      const int end_x = std::min(buffer.columns, kSoftTile * (x + 1) + 1),
                end_y = std::min(buffer.rows, kSoftTile * (y + 1) + 1);
      V nearest = Num(map->background), farthest = Num(3e38f);
      for (int by = kSoftTile * y; by < end_y; ++by) {
        const float* from = buffer.nearness[static_cast<size_t>(by) * buffer.columns].at;
        for (int i = kSoftPixels * kSoftTile * x; i < kSoftPixels * end_x; i += kLanes) {
          const V q = hn::Load(kFloats, from + i);
          nearest = hn::Max(nearest, q);
          farthest = hn::Min(farthest, q);
        }
      }
      map->nearest[tile] = hn::GetLane(hn::MaxOfLanes(kFloats, nearest));
      map->farthest[tile] = hn::GetLane(hn::MinOfLanes(kFloats, farthest));
    }
  }
}

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
  const SoftShadowMap& shadow_map = *shadow.map;
  // Most points are nearer than all that the map shows around them, or farther.
  const I tile =
      hn::Add(hn::Mul(hn::ShiftRight<kSoftTileBits>(row), hn::Set(kInts, shadow_map.tile_columns)),
              hn::ShiftRight<kSoftTileBits>(column));
  const M all_lit = hn::Ge(nearness, hn::GatherIndex(kFloats, shadow_map.nearest.data(), tile)),
          none_lit = hn::Lt(nearness, hn::GatherIndex(kFloats, shadow_map.farthest.data(), tile));
  const V plain = hn::IfThenElse(hn::Or(all_lit, hn::Not(inside)), one, zero);
  if (hn::AllTrue(kFloats, hn::Or(hn::Or(all_lit, none_lit), hn::Not(inside)))) return plain;
  const float* map = shadow_map.buffer.nearness[0].at;
  I columns[3];
  for (int k = 0; k < 3; ++k) {
    const I c = hn::Add(column, hn::Set(kInts, k));
    columns[k] = hn::Add(hn::ShiftLeft<4>(hn::ShiftRight<2>(c)), hn::And(c, three));
  }
  V sum = zero;
  M everywhere = hn::FirstN(kFloats, kLanes);
  for (int j = 0; j < 3; ++j) {
    const I r = hn::Add(row, hn::Set(kInts, j));
    const I start = hn::Add(
        hn::Mul(hn::ShiftRight<2>(r), hn::Set(kInts, kSoftPixels * shadow_map.buffer.columns)),
        hn::ShiftLeft<2>(hn::And(r, three)));
    V of_row = zero;
    for (int k = 0; k < 3; ++k) {
      const V first = hn::GatherIndex(kFloats, map, hn::Add(start, columns[k]));
      const M reached = hn::Ge(nearness, first);
      everywhere = hn::And(everywhere, reached);
      of_row = hn::Add(of_row, hn::IfThenElseZero(reached, across[k]));
    }
    sum = hn::Add(sum, hn::Mul(along[j], of_row));
  }
  // The weights' sum is rounded; points that are wholly lit are so exactly, as above.
  return hn::IfThenElse(hn::Or(everywhere, hn::Not(inside)), one, hn::Mul(sum, Num(0.25f)));
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
