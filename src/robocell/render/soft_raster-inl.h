// Triangles into blocks of pixels, a register of small ones at a time; part of soft_kernel.cc,
// compiled for each instruction set.
#if defined(ROBOCELL_SOFT_RASTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_RASTER_INL_H_
#undef ROBOCELL_SOFT_RASTER_INL_H_
#else
#define ROBOCELL_SOFT_RASTER_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "robocell/render/soft_blocks-inl.h"
#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_large-inl.h"
#include "robocell/render/soft_vertices-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
struct alignas(64) Batch {
  // Small triangles have their edge functions at the first pixel of each of their four blocks.
  static constexpr int kBlocks = 4;
  float e[kBlocks][3][kSoftPixels], right[3][kSoftPixels], down[3][kSoftPixels];
  float nearness[kSoftPixels], weight1[kSoftPixels], weight2[kSoftPixels];
  float low[kSoftPixels], high[kSoftPixels];
  float x[3][kSoftPixels], y[3][kSoftPixels];
  int32_t x0[kSoftPixels], x1[kSoftPixels], y0[kSoftPixels],
      y1[kSoftPixels];                  // blocks
  int32_t block[kBlocks][kSoftPixels];  // buffer position of a small triangle's blocks
  // Edge functions of middling triangles are whole numbers, and the steps are those of a pixel if
  // they are in pixels.
  int32_t whole[3][kSoftPixels];
  int32_t triangle[kSoftPixels];
};

// Moves bit k to bit 4 k.
HWY_INLINE uint64_t Spread(uint64_t bits) {
  bits = (bits | bits << 24) & 0x000000ff000000ffu;
  bits = (bits | bits << 12) & 0x000f000f000f000fu;
  bits = (bits | bits << 6) & 0x0303030303030303u;
  return (bits | bits << 3) & 0x1111111111111111u;
}

HWY_INLINE uint32_t BitsOf(M mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(kFloats, mask, bytes);
  return static_cast<uint32_t>(bytes[0] | bytes[1] << 8);
}

// Draws block `entry` % 4 of small triangle `entry` / 4.
template <bool kIds>
HWY_INLINE void DrawEntry(const Batch& b, int entry, uint32_t first_id, const ToCentres<kIds>& to) {
  SoftBuffer* buffer = to.buffer;
  const int i = entry / Batch::kBlocks, j = entry % Batch::kBlocks;
  const auto block = static_cast<size_t>(b.block[j][i]);
  const uint32_t id = first_id + static_cast<uint32_t>(b.triangle[i]);
  BlockEdges edges;
  for (int k = 0; k < 3; ++k) {
    edges.e[k] = b.e[j][k][i];
    edges.right[k] = b.right[k][i];
    edges.down[k] = b.down[k][i];
  }
  float* at = buffer->nearness[block].at;
  uint32_t* ids = kIds ? buffer->ids[block].at : nullptr;
  for (int part = 0; part < kSoftPixels; part += kLanes) {
    V e1, e2;
    const M covered = Inside(edges, part, &e1, &e2);
    const V q = hn::Add(Num(b.nearness[i]),
                        hn::Add(hn::Mul(e1, Num(b.weight1[i])), hn::Mul(e2, Num(b.weight2[i]))));
    Put<kIds>(covered, hn::Min(hn::Max(q, Num(b.low[i])), Num(b.high[i])), id, part, at, ids);
  }
}

// Returns an edge function in whole pixels, at a place that is this many steps from the batch's.
HWY_INLINE float WholeEdge(const Batch& b, int i, int k, int shift, int right, int down) {
  const auto dx = static_cast<int32_t>(b.right[k][i]), dy = static_cast<int32_t>(b.down[k][i]);
  return static_cast<float>((b.whole[k][i] + dx * right + dy * down) >> shift);
}

// Draws a triangle that meets a few blocks on each side: 4 x 4 blocks at a time are tested as
// those of a block's pixels are.
template <bool kIds>
HWY_INLINE void DrawMiddling(const SoftView& view, const Batch& b, int i, uint32_t id,
                             const ToCentres<kIds>& to) {
  SoftBuffer* buffer = to.buffer;
  const V nearness = Num(b.nearness[i]), weight1 = Num(b.weight1[i]), weight2 = Num(b.weight2[i]);
  const V low = Num(b.low[i]), high = Num(b.high[i]), zero = hn::Zero(kFloats);
  const int shift = __builtin_ctz(static_cast<unsigned>(view.steps));
  constexpr int kParts = kSoftPixels / kLanes;
  V steps[3][kParts], tile_steps[3][kParts];
  float first[3], right[3], down[3];
  for (int k = 0; k < 3; ++k) {
    right[k] = b.right[k][i];
    down[k] = b.down[k][i];
    first[k] = WholeEdge(b, i, k, shift, 0, 0);
    const V most = Num(3 * std::max(right[k], 0.0f) + 3 * std::max(down[k], 0.0f)), four = Num(4);
    for (int part = 0; part < kParts; ++part) {
      steps[k][part] = hn::Add(hn::Mul(Num(right[k]), hn::Load(kFloats, kColumn + kLanes * part)),
                               hn::Mul(Num(down[k]), hn::Load(kFloats, kRow + kLanes * part)));
      tile_steps[k][part] = hn::Add(most, hn::Mul(four, steps[k][part]));
    }
  }
  const int x0 = b.x0[i], y0 = b.y0[i], x1 = b.x1[i];
  const int begin = std::max(y0, to.rows.begin), y1 = std::min(b.y1[i], to.rows.end - 1);
  for (int ty = begin; ty <= y1; ty += kSoftBlock) {
    for (int tx = x0; tx <= x1; tx += kSoftBlock) {
      float at_tile[3];
      for (int k = 0; k < 3; ++k) {
        at_tile[k] = first[k] + (static_cast<float>(4 * (tx - x0)) * right[k] +
                                 static_cast<float>(4 * (ty - y0)) * down[k]);
      }
      uint32_t met = 0;
      for (int part = 0; part < kParts; ++part) {
        const auto most = [&](int k)
                              HWY_ATTR { return hn::Add(Num(at_tile[k]), tile_steps[k][part]); };
        met |= BitsOf(hn::Ge(hn::Min(most(0), hn::Min(most(1), most(2))), zero)) << (kLanes * part);
      }
      // Those beyond the triangle's box may be beyond the image.
      const int across = std::min(kSoftBlock, x1 - tx + 1),
                along = std::min(kSoftBlock, y1 - ty + 1);
      met &= (0x1111u * ((1u << across) - 1)) & ((1u << (kSoftBlock * along)) - 1);
      for (; met != 0; met &= met - 1) {
        const int which = __builtin_ctz(met);
        const int bx = which % kSoftBlock, by = which / kSoftBlock;
        const auto dx = static_cast<float>(4 * bx), dy = static_cast<float>(4 * by);
        V e[3];
        for (int k = 0; k < 3; ++k) e[k] = Num(at_tile[k] + (dx * right[k] + dy * down[k]));
        const size_t block = static_cast<size_t>(ty + by) * buffer->columns + (tx + bx);
        float* at = buffer->nearness[block].at;
        uint32_t* ids = kIds ? buffer->ids[block].at : nullptr;
        for (int part = 0; part < kParts; ++part) {
          const V e0 = hn::Add(e[0], steps[0][part]), e1 = hn::Add(e[1], steps[1][part]),
                  e2 = hn::Add(e[2], steps[2][part]);
          const M covered = hn::Ge(hn::Min(e0, hn::Min(e1, e2)), zero);
          const V q = hn::Add(nearness, hn::Add(hn::Mul(e1, weight1), hn::Mul(e2, weight2)));
          Put<kIds>(covered, hn::Min(hn::Max(q, low), high), id, kLanes * part, at, ids);
        }
      }
    }
  }
}

template <class To>
HWY_INLINE void DrawFacing(const SoftView& view, const SoftInstance& instance, int count,
                           SoftScratch* scratch, const To& to) {
  const SoftMesh& mesh = *instance.mesh;
  const float *px = scratch->x.data(), *py = scratch->y.data(), *pq = scratch->nearness.data();
  const V zero = hn::Zero(kFloats), half = Num(0.5f * view.steps), per_step = Num(1 / view.steps);
  const V steps = Num(view.steps), middling = Num(kMiddling * view.steps);
  // Positions of a pixel's last and first samples.
  V from = half, until = half;
  if constexpr (To::kSamples) {
    from = Num(0.5f * view.steps + static_cast<float>(to.margin));
    until = Num(0.5f * view.steps - static_cast<float>(to.margin));
  }
  const V last_x = Num(static_cast<float>(view.width - 1)),
          last_y = Num(static_cast<float>(view.height - 1));
  // The result for a triangle must not depend on the rows.
  const V top = Num(static_cast<float>(to.rows.begin)),
          bottom = Num(static_cast<float>(to.rows.end - 1));
  const SoftSide side = instance.side;
  int cut = 0;
  Batch b = {};
  // Fills the last register with the last triangle.
  for (auto* row :
       {&scratch->facing, &scratch->corners[0], &scratch->corners[1], &scratch->corners[2]}) {
    std::fill_n(row->begin() + count, kLanes, count ? (*row)[count - 1] : 0);
  }
  for (int i = 0; i < count; i += kLanes) {
    const I triangle = hn::LoadU(kInts, &scratch->facing[i]);
    const I i0 = hn::LoadU(kInts, &scratch->corners[0][i]),
            i1 = hn::LoadU(kInts, &scratch->corners[1][i]),
            i2 = hn::LoadU(kInts, &scratch->corners[2][i]);
    const V x0 = hn::GatherIndex(kFloats, px, i0), y0 = hn::GatherIndex(kFloats, py, i0);
    V x1 = hn::GatherIndex(kFloats, px, i1), y1 = hn::GatherIndex(kFloats, py, i1);
    V x2 = hn::GatherIndex(kFloats, px, i2), y2 = hn::GatherIndex(kFloats, py, i2);
    const V low_x = hn::Min(x0, hn::Min(x1, x2)), high_x = hn::Max(x0, hn::Max(x1, x2));
    const V low_y = hn::Min(y0, hn::Min(y1, y2)), high_y = hn::Max(y0, hn::Max(y1, y2));
    const V first_x = hn::Max(zero, hn::Ceil(hn::Mul(hn::Sub(low_x, from), per_step)));
    const V first_y = hn::Max(zero, hn::Ceil(hn::Mul(hn::Sub(low_y, from), per_step)));
    const V end_x = hn::Min(last_x, hn::Floor(hn::Mul(hn::Sub(high_x, until), per_step)));
    const V end_y = hn::Min(last_y, hn::Floor(hn::Mul(hn::Sub(high_y, until), per_step)));
    const M beyond = hn::Gt(high_x, Num(kReach));
    M seen = hn::And(hn::Le(first_x, end_x), hn::Le(first_y, end_y));
    seen = hn::Or(seen, beyond);
    seen = hn::And(seen, hn::FirstN(kFloats, static_cast<size_t>(count - i)));
    // Computes the blocks. Pixels are below 16 bits, so that their quarters are exact.
    const V quarter = Num(0.25f);
    const V bx0 = hn::Floor(hn::Mul(first_x, quarter)), by0 = hn::Floor(hn::Mul(first_y, quarter));
    const V bx1 = hn::Floor(hn::Mul(end_x, quarter)), by1 = hn::Floor(hn::Mul(end_y, quarter));
    seen = hn::And(seen, hn::Or(beyond, hn::And(hn::Ge(by1, top), hn::Le(by0, bottom))));
    if constexpr (To::kSamples) {
      seen =
          hn::And(seen, hn::Or(beyond, to.AtEdges(hn::AndNot(beyond, seen), bx0, by0, bx1, by1)));
    }
    if (hn::AllFalse(kFloats, seen)) continue;
    V q0 = hn::GatherIndex(kFloats, pq, i0), q1 = hn::GatherIndex(kFloats, pq, i1),
      q2 = hn::GatherIndex(kFloats, pq, i2);
    const V low = hn::Min(q0, hn::Min(q1, q2)), high = hn::Max(q0, hn::Max(q1, q2));
    seen = hn::And(seen, hn::Ge(high, zero));
    const M small = hn::AndNot(beyond, hn::And(hn::Le(hn::Sub(high_x, low_x), Num(kSmall)),
                                               hn::Le(hn::Sub(high_y, low_y), Num(kSmall))));
    const M fits = hn::AndNot(beyond, hn::And(hn::Le(hn::Sub(high_x, low_x), middling),
                                              hn::Le(hn::Sub(high_y, low_y), middling)));
    const auto whole = [&](V v)
                           HWY_ATTR { return hn::ConvertTo(kInts, hn::IfThenElseZero(fits, v)); };
    V area = hn::Sub(hn::Mul(hn::Sub(x2, x0), hn::Sub(y1, y0)),
                     hn::Mul(hn::Sub(y2, y0), hn::Sub(x1, x0)));
    if (!hn::AllTrue(kFloats, small)) {
      const I exact = hn::Sub(hn::Mul(whole(hn::Sub(x2, x0)), whole(hn::Sub(y1, y0))),
                              hn::Mul(whole(hn::Sub(y2, y0)), whole(hn::Sub(x1, x0))));
      area = hn::IfThenElse(fits, hn::ConvertTo(kFloats, exact), area);
    }
    if (side != SoftSide::kFront) {
      const M back = hn::Lt(area, zero);
      const M turn = side == SoftSide::kBack ? hn::Eq(area, area) : back;
      const auto swap = [&](V* a, V* c) HWY_ATTR {
        const V old = *a;
        *a = hn::IfThenElse(turn, *c, *a);
        *c = hn::IfThenElse(turn, old, *c);
      };
      swap(&x1, &x2);
      swap(&y1, &y2);
      swap(&q1, &q2);
      area = hn::IfThenElse(turn, hn::Neg(area), area);
    }
    seen = hn::And(seen, hn::Or(hn::Not(small), hn::Gt(area, zero)));

    const M tiny = hn::And(
        small, hn::And(hn::Le(hn::Sub(bx1, bx0), Num(1)), hn::Le(hn::Sub(by1, by0), Num(1))));
    const M draw_small = hn::And(seen, tiny);
    const M draw_middling = hn::And(hn::AndNot(tiny, seen), hn::And(fits, hn::Gt(area, zero)));
    const M draw_large = hn::AndNot(hn::Or(tiny, fits), seen);

    uint64_t entries = 0;  // blocks of small ones: bit 4 * triangle + block
    if (!hn::AllFalse(kFloats, hn::Or(draw_small, draw_middling))) {
      const V ox = hn::Add(hn::Mul(bx0, hn::Mul(Num(4), steps)), half),
              oy = hn::Add(hn::Mul(by0, hn::Mul(Num(4), steps)), half);
      const bool none_middling = hn::AllFalse(kFloats, draw_middling);
      // Finds the blocks that a small triangle may cover.
      const M wide = hn::Gt(bx1, bx0);
      const M upper = hn::And(draw_small, hn::Ge(by0, top)),
              lower = hn::And(hn::And(draw_small, hn::Gt(by1, by0)), hn::Lt(by0, bottom));
      M meets[Batch::kBlocks] = {upper, hn::And(upper, wide), lower, hn::And(lower, wide)};
      const auto edge = [&](int k, V ax, V ay, V bx, V by) HWY_ATTR {
        const V dx = hn::Sub(ay, by), dy = hn::Sub(bx, ax);
        const M inclusive = hn::Or(hn::Gt(dx, zero), hn::And(hn::Eq(dx, zero), hn::Gt(dy, zero)));
        const V e = hn::Sub(hn::Mul(hn::Sub(ax, ox), hn::Sub(by, oy)),
                            hn::Mul(hn::Sub(ay, oy), hn::Sub(bx, ox)));
        const V first = hn::Sub(e, hn::IfThenElse(inclusive, zero, Num(1)));
        const V right = hn::IfThenElse(tiny, hn::Mul(dx, steps), dx),
                down = hn::IfThenElse(tiny, hn::Mul(dy, steps), dy);
        hn::Store(right, kFloats, b.right[k]);
        hn::Store(down, kFloats, b.down[k]);
        const V block_right = hn::Mul(Num(4), right), block_down = hn::Mul(Num(4), down);
        const V below = hn::Add(first, block_down);
        const V at_block[] = {first, hn::Add(first, block_right), below,
                              hn::Add(below, block_right)};
        // Largest contribution of a block's pixels.
        const V most = hn::Mul(Num(3), hn::Add(hn::Max(right, zero), hn::Max(down, zero)));
        for (int j = 0; j < Batch::kBlocks; ++j) {
          hn::Store(at_block[j], kFloats, b.e[j][k]);
          meets[j] = hn::And(meets[j], hn::Ge(hn::Add(at_block[j], most), zero));
        }
        if (none_middling) return;
        const I exact = hn::Sub(hn::Mul(whole(hn::Sub(ax, ox)), whole(hn::Sub(by, oy))),
                                hn::Mul(whole(hn::Sub(ay, oy)), whole(hn::Sub(bx, ox))));
        hn::Store(hn::Sub(exact, hn::IfThenElseZero(hn::RebindMask(kInts, hn::Not(inclusive)),
                                                    hn::Set(kInts, 1))),
                  kInts, b.whole[k]);
      };
      edge(0, x2, y2, x1, y1);
      edge(1, x0, y0, x2, y2);
      edge(2, x1, y1, x0, y0);
      const V per_area = hn::Div(hn::IfThenElse(tiny, Num(1), steps), area);
      hn::Store(q0, kFloats, b.nearness);
      hn::Store(hn::Mul(hn::Sub(q1, q0), per_area), kFloats, b.weight1);
      hn::Store(hn::Mul(hn::Sub(q2, q0), per_area), kFloats, b.weight2);
      hn::Store(low, kFloats, b.low);
      hn::Store(high, kFloats, b.high);
      const I column = hn::ConvertTo(kInts, bx0), row = hn::ConvertTo(kInts, by0);
      hn::Store(column, kInts, b.x0);
      hn::Store(hn::ConvertTo(kInts, bx1), kInts, b.x1);
      hn::Store(row, kInts, b.y0);
      hn::Store(hn::ConvertTo(kInts, by1), kInts, b.y1);
      if constexpr (!To::kSamples) {
        const I columns = hn::Set(kInts, to.buffer->columns), one = hn::Set(kInts, 1);
        const I block = hn::Add(hn::Mul(row, columns), column), below = hn::Add(block, columns);
        const I at_block[] = {block, hn::Add(block, one), below, hn::Add(below, one)};
        for (int j = 0; j < Batch::kBlocks; ++j) {
          hn::Store(at_block[j], kInts, b.block[j]);
          entries |= Spread(BitsOf(meets[j])) << j;
        }
      }
    }
    hn::Store(triangle, kInts, b.triangle);
    hn::Store(x0, kFloats, b.x[0]);
    hn::Store(x1, kFloats, b.x[1]);
    hn::Store(x2, kFloats, b.x[2]);
    hn::Store(y0, kFloats, b.y[0]);
    hn::Store(y1, kFloats, b.y[1]);
    hn::Store(y2, kFloats, b.y[2]);
    hn::Store(low, kFloats, b.low);
    hn::Store(high, kFloats, b.high);
    // Draws in the order of the mesh, independent of sizes: of triangles at one place the last is
    // visible.
    const uint32_t of_small = BitsOf(draw_small), of_middling = BitsOf(draw_middling),
                   of_large = BitsOf(draw_large), of_cut = BitsOf(hn::And(draw_large, beyond));
    if constexpr (!To::kSamples) {
      for (uint32_t rest = of_small | of_middling; rest != 0; rest &= rest - 1) {
        const int k = __builtin_ctz(rest);
        to.Prefetch(b.x0[k], b.y0[k]);
      }
      if ((of_middling | of_large) == 0) {
        for (; entries != 0; entries &= entries - 1) {
          DrawEntry(b, __builtin_ctzll(entries), instance.first_id, to);
        }
        continue;
      }
    }
    for (uint32_t rest = of_small | of_middling | of_large; rest != 0; rest &= rest - 1) {
      const int k = __builtin_ctz(rest);
      const uint32_t id = instance.first_id + static_cast<uint32_t>(b.triangle[k]);
      if (of_small >> k & 1) {
        if constexpr (To::kSamples) {
          DrawSmall(b, k, id, to);
        } else {
          for (uint64_t its = entries >> (Batch::kBlocks * k) & 15; its != 0; its &= its - 1) {
            DrawEntry(b, Batch::kBlocks * k + __builtin_ctzll(its), instance.first_id, to);
          }
        }
      } else if (of_middling >> k & 1) {
        DrawMiddling(view, b, k, id, to);
      } else if (of_cut >> k & 1) {
        scratch->cut[cut++] = b.triangle[k];
      } else {
        // Already ordered: a back face has the wrong sign.
        Point p[3];
        for (int c = 0; c < 3; ++c) {
          p[c] = {static_cast<int64_t>(b.x[c][k]), static_cast<int64_t>(b.y[c][k])};
        }
        if (!Orient(side == SoftSide::kBoth ? side : SoftSide::kFront, p)) continue;
        ViewPoint v[3];
        for (int c = 0; c < 3; ++c) {
          v[c] = InView(instance, mesh.corners[c][b.triangle[k]]);
        }
        PlaneNearness plane;
        if (!PlaneOf(view, v, &plane)) continue;
        DrawLarge(view, p, plane, b.low[k], b.high[k], id, to);
      }
    }
  }
  for (int k = 0; k < cut; ++k) DrawCut(view, instance, scratch->cut[k], to);
}

inline void DrawInstanceHere(const SoftView& view, const SoftInstance& instance,
                             SoftScratch* scratch, SoftBuffer* buffer) {
  const SoftRows rows = BlockRows(view);
  const auto draw = [&](const auto& to) HWY_ATTR {
    DrawFacing(view, instance, Prepare(view, instance, to, scratch), scratch, to);
  };
  if (buffer->ids.empty()) {
    draw(ToCentres<false>{buffer, rows});
  } else {
    draw(ToCentres<true>{buffer, rows});
  }
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
