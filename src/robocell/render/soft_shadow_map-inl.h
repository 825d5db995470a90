// Shadow maps: the share of a light that reaches points; part of soft_kernel.cc, compiled for each
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

// Computes the nearest and farthest surface of each tile in which something may have been drawn. A
// tile's numbers cover all pixels that points in it read: one row and one column of blocks more.
inline void SummariseMapHere(SoftShadowMap* map, SoftRows rows) {
  const SoftBuffer& buffer = map->buffer;
  const int tile_rows = map->tile_rows, tile_columns = map->tile_columns;
  const auto drawn = [&](int x, int y) {
    return x < tile_columns && y < tile_rows && map->drawn[y * tile_columns + x] != 0;
  };
  for (int y = rows.begin; y < rows.end; ++y) {
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

// Share of a light that reaches points, with a soft edge of two pixels of the map: at these places
// of it, where it shows them.
HWY_INLINE V LitAt(const SoftShadow& shadow, M inside, V u, V v, V nearness) {
  const V zero = hn::Zero(kFloats), one = Num(1);
  const V last = Num(static_cast<float>(shadow.view.width - 4));
  // Points outside of the map are lit.
  inside = hn::And(inside, hn::And(hn::And(hn::Gt(u, one), hn::Lt(u, last)),
                                   hn::And(hn::Gt(v, one), hn::Lt(v, last))));
  if (hn::AllFalse(kFloats, inside)) return one;
  const V us = hn::IfThenElseZero(inside, u), vs = hn::IfThenElseZero(inside, v);
  const V u0 = hn::Floor(us), v0 = hn::Floor(vs);
  const V fu = hn::Sub(us, u0), fv = hn::Sub(vs, v0);
  const I column = hn::ConvertTo(kInts, u0), row_of = hn::ConvertTo(kInts, v0);
  const I three = hn::Set(kInts, 3);
  const SoftShadowMap& shadow_map = *shadow.map;
  // Most points are nearer than all surfaces of the map around them, or farther.
  const I tile = hn::Add(
      hn::Mul(hn::ShiftRight<kSoftTileBits>(row_of), hn::Set(kInts, shadow_map.tile_columns)),
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
  I rows[3];
  for (int k = 0; k < 3; ++k) {
    const I r = hn::Add(row_of, hn::Set(kInts, k));
    rows[k] = hn::Add(
        hn::Mul(hn::ShiftRight<2>(r), hn::Set(kInts, kSoftPixels * shadow_map.buffer.columns)),
        hn::ShiftLeft<2>(hn::And(r, three)));
  }
  const auto reached = [&](int j, int k) HWY_ATTR {
    return hn::Ge(nearness, hn::GatherIndex(kFloats, map, hn::Add(rows[j], columns[k])));
  };
  // If the four corner pixels of nine agree, the others do too.
  const M a = reached(0, 0), b = reached(0, 2), c = reached(2, 0), d = reached(2, 2);
  const M lit = hn::Or(hn::And(hn::And(a, b), hn::And(c, d)), hn::Not(inside)),
          dark = hn::Not(hn::Or(hn::Or(a, b), hn::Or(c, d)));
  const V agreed = hn::IfThenElseZero(lit, one);
  if (hn::AllTrue(kFloats, hn::Or(lit, dark))) return agreed;
  const auto weighted = [&](M of, V weight) HWY_ATTR { return hn::IfThenElseZero(of, weight); };
  const auto line = [&](M first, M second, M third) HWY_ATTR {
    return hn::Add(hn::Add(weighted(first, hn::Sub(one, fu)), weighted(second, one)),
                   weighted(third, fu));
  };
  const V upper = line(a, reached(0, 1), b),
          middle = line(reached(1, 0), reached(1, 1), reached(1, 2)),
          lower = line(c, reached(2, 1), d);
  const V sum = hn::Add(hn::Add(hn::Mul(hn::Sub(one, fv), upper), middle), hn::Mul(fv, lower));
  return hn::IfThenElse(hn::Or(lit, dark), agreed, hn::Mul(sum, Num(0.25f)));
}

// Offset of points from a surface, in pixels of the map: surfaces are rounded to these, the
// more so where light grazes. `facing` is the cosine between normal and light.
HWY_INLINE V LiftPixels(V facing) {
  // About the sine.
  const V facing2 = hn::Mul(facing, facing), one = Num(1);
  const V slant =
      hn::Sub(one, hn::Mul(hn::Mul(Num(0.5f), facing2), hn::Add(one, hn::Mul(facing2, facing2))));
  return hn::Add(Num(0.7f), hn::Mul(Num(1.8f), slant));
}
// Returns the offset in metres, for light from far away.
HWY_INLINE float LiftOf(const SoftShadow& shadow, float facing) {
  return shadow.view.per_fx * hn::GetLane(LiftPixels(Num(facing)));
}

// Returns the light on points of a surface. `facing` is the cosine between normal and light.
HWY_INLINE V Lit(const SoftShadow& shadow, const V3& at, const V3& normal, V facing) {
  const V zero = hn::Zero(kFloats), one = Num(1);
  const M towards = hn::Gt(facing, zero);
  if (hn::AllFalse(kFloats, towards)) return one;
  const SoftView& view = shadow.view;
  const float* m = shadow.to_map;
  const auto row = [&](int k, const V3& p)
                       HWY_ATTR { return hn::Add(Dot(Set3(m + 4 * k), p), Num(m[4 * k + 3])); };
  V pixel = Num(view.per_fx);
  if (!view.orthographic) pixel = hn::Mul(pixel, hn::Max(row(2, at), zero));
  const V lift = hn::Mul(pixel, LiftPixels(facing));
  const V3 p = Add(at, Times(lift, normal));
  V u = row(0, p), v = row(1, p), nearness = row(2, p);
  M inside = towards;
  if (view.orthographic) {
    inside = hn::And(inside, hn::Lt(nearness, one));
  } else {
    inside = hn::And(inside, hn::Gt(nearness, Num(view.near)));
    nearness = hn::Div(one, hn::Max(nearness, Num(1e-6f)));
    u = hn::Add(hn::Mul(u, nearness), Num(view.cx - 0.5f));
    v = hn::Add(hn::Mul(v, nearness), Num(view.cy - 0.5f));
  }
  return LitAt(shadow, inside, u, v, nearness);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
