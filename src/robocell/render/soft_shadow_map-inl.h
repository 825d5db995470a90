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
#include <cmath>
#include <cstdint>

#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_pixels-inl.h"
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

// The pixels of a map around points that lie close together: 4 x 4, row after row, in registers.
struct MapWindow {
  static constexpr int kSide = 4, kRegisters = kSide * kSide / kLanes;
  V at[kRegisters];
  I corner;  // where the 3 x 3 pixels of each point begin

  // Points read the pixels from (column, row) to two further on. Returns false if they lie too far
  // apart; those that are not `inside` do not count.
  HWY_INLINE bool Find(const SoftShadowMap& map, M inside, I column, I row) {
    const auto counted = hn::RebindMask(kInts, inside);
    const I none = hn::Set(kInts, 1 << 30);
    const auto least = [&](I of) HWY_ATTR {
      return hn::Set(kInts, hn::GetLane(hn::MinOfLanes(kInts, hn::IfThenElse(counted, of, none))));
    };
    const I first_column = least(column), first_row = least(row);
    const I right = hn::Sub(column, first_column), down = hn::Sub(row, first_row);
    const I two = hn::Set(kInts, 2);
    if (!hn::AllTrue(kInts, hn::Or(hn::Not(counted), hn::Lt(hn::Max(right, down), two)))) {
      return false;
    }
    corner = hn::IfThenElseZero(counted, hn::Add(hn::ShiftLeft<2>(down), right));
    const I three = hn::Set(kInts, kSide - 1), stride = hn::Set(kInts, map.buffer.columns);
    for (int k = 0; k < kRegisters; ++k) {
      const I lane = hn::Iota(kInts, k * kLanes);
      const I c = hn::Add(first_column, hn::And(lane, three)),
              r = hn::Add(first_row, hn::ShiftRight<2>(lane));
      const I block = hn::Add(hn::Mul(hn::ShiftRight<2>(r), stride), hn::ShiftRight<2>(c));
      const I pixel = hn::Add(hn::ShiftLeft<2>(hn::And(r, three)), hn::And(c, three));
      at[k] = hn::GatherIndex(kFloats, map.buffer.nearness[0].at,
                              hn::Add(hn::ShiftLeft<4>(block), pixel));
    }
    return true;
  }

  // The pixels `right` and `down` of the corners.
  HWY_INLINE V Of(int right, int down) const {
    const I place = hn::Add(corner, hn::Set(kInts, kSide * down + right));
    const auto from = hn::IndicesFromVec(kFloats, hn::And(place, hn::Set(kInts, kLanes - 1)));
    V found = hn::TableLookupLanes(at[0], from);
    for (int k = 1; k < kRegisters; ++k) {
      const M later = hn::RebindMask(kFloats, hn::Gt(place, hn::Set(kInts, k * kLanes - 1)));
      found = hn::IfThenElse(later, hn::TableLookupLanes(at[k], from), found);
    }
    return found;
  }
};

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
  const SoftShadowMap& shadow_map = *shadow.map;
  // `reached(j, k)`: the points that the pixel in row j and column k of nine does not hide.
  const auto share = [&](const auto& reached) HWY_ATTR {
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
  };
  // The points of a block are often closer together than the pixels of the map.
  if constexpr (kLanes >= 8) {
    MapWindow window;
    if (window.Find(shadow_map, inside, column, row_of)) {
      return share([&](int j, int k) HWY_ATTR { return hn::Ge(nearness, window.Of(k, j)); });
    }
  }
  // Most points are nearer than all surfaces of the map around them, or farther.
  const I tile = hn::Add(
      hn::Mul(hn::ShiftRight<kSoftTileBits>(row_of), hn::Set(kInts, shadow_map.tile_columns)),
      hn::ShiftRight<kSoftTileBits>(column));
  const M all_lit = hn::Ge(nearness, hn::GatherIndex(kFloats, shadow_map.nearest.data(), tile)),
          none_lit = hn::Lt(nearness, hn::GatherIndex(kFloats, shadow_map.farthest.data(), tile));
  if (hn::AllTrue(kFloats, hn::Or(hn::Or(all_lit, none_lit), hn::Not(inside)))) {
    return hn::IfThenElse(hn::Or(all_lit, hn::Not(inside)), one, zero);
  }
  const float* map = shadow_map.buffer.nearness[0].at;
  const I three = hn::Set(kInts, 3);
  I columns[3], rows[3];
  for (int k = 0; k < 3; ++k) {
    const I c = hn::Add(column, hn::Set(kInts, k)), r = hn::Add(row_of, hn::Set(kInts, k));
    columns[k] = hn::Add(hn::ShiftLeft<4>(hn::ShiftRight<2>(c)), hn::And(c, three));
    rows[k] = hn::Add(
        hn::Mul(hn::ShiftRight<2>(r), hn::Set(kInts, kSoftPixels * shadow_map.buffer.columns)),
        hn::ShiftLeft<2>(hn::And(r, three)));
  }
  return share([&](int j, int k) HWY_ATTR {
    return hn::Ge(nearness, hn::GatherIndex(kFloats, map, hn::Add(rows[j], columns[k])));
  });
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
// The change of nearness to the right and down a map, on a plane under light from far away.
struct PlaneInMap {
  float right = 0, down = 0;

  PlaneInMap() = default;
  PlaneInMap(const SoftShadow& shadow, const float* normal) {
    // The rows of the map are at right angles, so the inverse is their transpose, scaled.
    const auto part = [&](int k) {
      const float* row = shadow.to_map + 4 * k;
      return ((row[0] * normal[0] + row[1] * normal[1]) + row[2] * normal[2]) /
             ((row[0] * row[0] + row[1] * row[1]) + row[2] * row[2]);
    };
    const float along = part(2);
    const float steep = -1 / std::copysign(std::max(std::abs(along), 1e-20f), along);
    right = part(0) * steep;
    down = part(1) * steep;
  }

  HWY_INLINE V At(V u, V v) const { return hn::Add(hn::Mul(Num(right), u), hn::Mul(Num(down), v)); }
  // The largest and the least change to the pixels that a point reads: those from one before it to
  // two after it. Some rounding is added.
  float most() const { return std::max(2 * right, -right) + std::max(2 * down, -down) + 1e-6f; }
  float least() const { return std::min(2 * right, -right) + std::min(2 * down, -down) - 1e-6f; }
};

// Finds the tiles of the map that the colours of blocks depend on. `wanted`: null, or a flag of each
// block; the others keep theirs.
inline void FindReachHere(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                          const uint8_t* wanted, const SoftShadow& shadow, SoftReach* reach) {
  // Points are lifted by up to 2.5 pixels, and limits cover five beside theirs. Lamps that light up to
  // 80 degrees to the side lift points by up to 2.5 (1 + tan 80) = 17 pixels; they read three beside
  // theirs and no limits of larger tiles.
  constexpr float kBeside = 7, kTilePixels = kSoftTile * kSoftBlock;
  static_assert(kTilePixels + kBeside >= 17 + 3);
  const SoftView& view = shadow.view;
  // A lift may bring points before the near plane: from here on, on maps of 6 pixels and more.
  const float nearest = 0.15f * view.near;
  const float* m = shadow.to_map;
  const auto side = static_cast<float>(view.width);
  const int limit[2] = {shadow.map->tile_columns, shadow.map->tile_rows};
  for (int by = rows.begin; by < rows.end; ++by) {
    for (int bx = 0; bx < buffer.columns; ++bx) {
      const size_t block =
          static_cast<size_t>(by) * static_cast<size_t>(buffer.columns) + static_cast<size_t>(bx);
      if (wanted && !wanted[block]) continue;
      V low[2] = {Num(3e38f), Num(3e38f)}, high[2] = {Num(-3e38f), Num(-3e38f)};
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        const I ids =
            hn::Load(kInts, reinterpret_cast<const int32_t*>(buffer.ids[block].at) + part);
        const Pixels p = PixelsAt(*picture.view, bx, by, part,
                                  hn::Load(kFloats, buffer.nearness[block].at + part));
        const auto row = [&](int k) HWY_ATTR {
          return hn::Add(Dot(Set3(m + 4 * k), p.at), Num(m[4 * k + 3]));
        };
        M read = hn::RebindMask(kFloats, hn::Gt(ids, hn::Set(kInts, -1)));
        V at[2] = {row(0), row(1)};
        if (!view.orthographic) {
          const V depth = row(2);
          read = hn::And(read, hn::Gt(depth, Num(nearest)));
          const V nearness = hn::Div(Num(1), hn::Max(depth, Num(nearest)));
          at[0] = hn::Add(hn::Mul(at[0], nearness), Num(view.cx - 0.5f));
          at[1] = hn::Add(hn::Mul(at[1], nearness), Num(view.cy - 0.5f));
        }
        for (int c = 0; c < 2; ++c) {
          low[c] = hn::Min(low[c], hn::IfThenElse(read, at[c], Num(3e38f)));
          high[c] = hn::Max(high[c], hn::IfThenElse(read, at[c], Num(-3e38f)));
        }
      }
      SoftReach& to = reach[block];
      to = {};
      float from[2], until[2];
      for (int c = 0; c < 2; ++c) {
        from[c] = hn::GetLane(hn::MinOfLanes(kFloats, low[c]));
        until[c] = hn::GetLane(hn::MaxOfLanes(kFloats, high[c]));
      }
      if (from[0] > until[0]) continue;
      // Limits of larger tiles decide for blocks that are large on the map.
      const float extent = std::max(until[0] - from[0], until[1] - from[1]);
      const float around = std::max(kTilePixels, 2 * extent) + kBeside;
      for (int c = 0; c < 2; ++c) {
        to.begin[c] =
            static_cast<int16_t>(std::clamp(from[c] - around, 0.0f, side) * (1 / kTilePixels));
        to.end[c] = static_cast<int16_t>(std::min(
            limit[c],
            static_cast<int>(std::clamp(until[c] + around, 0.0f, side) * (1 / kTilePixels)) + 1));
      }
    }
  }
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
