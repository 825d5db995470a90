// Samples beside the centres of pixels, for smooth edges; part of soft_kernel.cc, compiled for each
// instruction set. Only blocks that show an edge between surfaces have samples: FindEdgesHere lists
// them from what the centres show, and DrawSamplesHere draws into them alone.
#if defined(ROBOCELL_SOFT_SAMPLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_SAMPLES_INL_H_
#undef ROBOCELL_SOFT_SAMPLES_INL_H_
#else
#define ROBOCELL_SOFT_SAMPLES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_raster-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

// Surfaces whose nearness differs by less than this share are one surface.
constexpr float kOneSurface = 0.02f;

// ---- The blocks that show an edge

// Returns true if all pixels of a block and those right of it and below show triangle `id`.
HWY_INLINE bool ShowsOne(const SoftBuffer& buffer, size_t block, bool has_right, bool has_below) {
  const uint32_t* ids = buffer.ids[block].at;
  const auto id = static_cast<int32_t>(ids[0]);
  const I one = hn::Set(kInts, id);
  for (int part = 0; part < kSoftPixels; part += kLanes) {
    const I here = hn::Load(kInts, reinterpret_cast<const int32_t*>(ids) + part);
    if (!hn::AllTrue(kInts, hn::Eq(here, one))) return false;
  }
  uint32_t other = 0;
  if (has_right) {
    const uint32_t* right = buffer.ids[block + 1].at;
    other |= (right[0] ^ ids[0]) | (right[4] ^ ids[0]) | (right[8] ^ ids[0]) | (right[12] ^ ids[0]);
  }
  if (has_below) {
    const uint32_t* below = buffer.ids[block + buffer.columns].at;
    other |= (below[0] ^ ids[0]) | (below[1] ^ ids[0]) | (below[2] ^ ids[0]) | (below[3] ^ ids[0]);
    if (has_right) other |= below[kSoftPixels] ^ ids[0];
  }
  return other == 0;
}

// Returns true if no pixel of a block, of that right of it and of those below meets another
// surface: a quick answer for what lies within a surface of small triangles.
HWY_INLINE bool ShowsOneSurface(const SoftBuffer& buffer, size_t block, bool has_right,
                                bool has_below) {
  const size_t right = has_right ? 1 : 0,
               below = has_below ? static_cast<size_t>(buffer.columns) : 0;
  const I first = hn::Set(kInts, static_cast<int32_t>(buffer.ids[block].at[0]));
  I other = hn::Zero(kInts);
  V least = hn::Load(kFloats, buffer.nearness[block].at), most = least;
  for (const size_t at : {block, block + right, block + below, block + below + right}) {
    for (int part = 0; part < kSoftPixels; part += kLanes) {
      const auto* ids = reinterpret_cast<const int32_t*>(buffer.ids[at].at) + part;
      other = hn::Or(other, hn::Xor(first, hn::Load(kInts, ids)));
      const V q = hn::Load(kFloats, buffer.nearness[at].at + part);
      least = hn::Min(least, q);
      most = hn::Max(most, q);
    }
  }
  if (!hn::AllTrue(kInts, hn::Eq(hn::ShiftRight<kSoftRunBits>(other), hn::Zero(kInts)))) {
    return false;
  }
  const float low = hn::GetLane(hn::MinOfLanes(kFloats, least)),
              high = hn::GetLane(hn::MaxOfLanes(kFloats, most));
  return high - low <= 0.75f * kOneSurface * low;
}

using Four = hn::CappedTag<float, kSoftBlock>;
using FourInts = hn::RebindToSigned<Four>;

// Marks the block, and those beside it, whose pixels border on another surface.
HWY_INLINE void MarkEdges(const SoftBuffer& buffer, size_t block, bool has_right, bool has_below,
                          int32_t* marks) {
  constexpr Four four;
  constexpr FourInts four_ints;
  constexpr int kStride = 8;
  alignas(32) float q[5 * kStride];
  alignas(32) uint32_t ids[5 * kStride];
  const auto copy = [&](const auto& from, auto* to, int row, size_t at, int from_row, int count) {
    std::memcpy(to + kStride * row, from[at].at + kSoftBlock * from_row,
                static_cast<size_t>(count) * 4);
  };
  const size_t right = has_right ? block + 1 : block,
               below = has_below ? block + static_cast<size_t>(buffer.columns) : block,
               beyond = below + (right - block);
  const auto fill = [&](const auto& from, auto* to) {
    for (int r = 0; r < 4; ++r) {
      copy(from, to, r, block, r, 4);
      to[kStride * r + 4] = from[right].at[4 * r + (has_right ? 0 : 3)];
    }
    copy(from, to, 4, below, has_below ? 0 : 3, 4);
    to[kStride * 4 + 4] = from[beyond].at[(has_below ? 0 : 12) + (has_right ? 0 : 3)];
  };
  fill(buffer.nearness, q);
  fill(buffer.ids, ids);
  // Compares pairs in these directions: to the right, down, and both diagonals.
  const auto differ = [&](int a, int b) HWY_ATTR {
    unsigned pairs = 0;
    for (int k = 0; k < kSoftBlock; k += static_cast<int>(hn::Lanes(four))) {
      const auto qa = hn::LoadU(four, q + a + k), qb = hn::LoadU(four, q + b + k);
      const auto ia = hn::LoadU(four_ints, reinterpret_cast<const int32_t*>(ids) + a + k),
                 ib = hn::LoadU(four_ints, reinterpret_cast<const int32_t*>(ids) + b + k);
      const auto other = hn::Ne(hn::ShiftRight<kSoftRunBits>(hn::Xor(ia, ib)), hn::Zero(four_ints));
      const auto apart = hn::Gt(hn::Abs(hn::Sub(qa, qb)),
                                hn::Mul(hn::Set(four, 0.75f * kOneSurface), hn::Min(qa, qb)));
      uint8_t bits[8] = {};
      hn::StoreMaskBits(four, hn::Or(apart, hn::RebindMask(four, other)), bits);
      pairs |= static_cast<unsigned>(bits[0]) << k;
    }
    return pairs;
  };
  unsigned here = 0, at_right = 0, at_below = 0, at_beyond = 0;
  for (int r = 0; r < 4; ++r) {
    const int at = kStride * r;
    const unsigned across = differ(at, at + 1), along = differ(at, at + kStride),
                   falling = differ(at, at + kStride + 1), rising = differ(at + 1, at + kStride);
    here |= across | along | falling;
    at_right |= (across | rising) & 8;
    if (r < 3) {
      here |= rising;
      at_right |= falling & 8;
    } else {
      here |= rising & 7;
      at_below |= along | (falling & 7) | rising;
      at_beyond |= falling & 8;
    }
  }
  if (here) marks[block] = 1;
  if (at_right && has_right) marks[right] = 1;
  if (at_below && has_below) marks[below] = 1;
  if (at_beyond && has_right && has_below) marks[beyond] = 1;
}

// Gives each block that shows an edge a slot; returns their number. `wanted`: null, or a flag of each
// block; the others get none.
inline int FindEdgesHere(const SoftBuffer& buffer, const uint8_t* wanted, SoftSamples* samples) {
  int32_t* slots = samples->slots.data();
  const size_t blocks = buffer.ids.size();
  std::fill_n(slots, blocks, 0);
  for (int by = 0; by < buffer.rows; ++by) {
    for (int bx = 0; bx < buffer.columns; ++bx) {
      const size_t block = static_cast<size_t>(by) * buffer.columns + bx;
      const bool has_right = bx + 1 < buffer.columns, has_below = by + 1 < buffer.rows;
      if (wanted) {  // it may mark these
        const size_t below = has_below ? block + static_cast<size_t>(buffer.columns) : block;
        const size_t right = has_right ? 1 : 0;
        if (!(wanted[block] | wanted[block + right] | wanted[below] | wanted[below + right])) {
          continue;
        }
      }
      if (ShowsOne(buffer, block, has_right, has_below) ||
          ShowsOneSurface(buffer, block, has_right, has_below)) {
        continue;
      }
      MarkEdges(buffer, block, has_right, has_below, slots);
    }
  }
  int used = 0;
  const size_t stride = static_cast<size_t>(buffer.columns) + 1;
  int32_t* before = samples->before.data();
  std::fill_n(before, stride, 0);
  for (int by = 0; by < buffer.rows; ++by, before += stride, slots += buffer.columns) {
    int32_t in_row = before[stride] = 0;
    for (int bx = 0; bx < buffer.columns; ++bx) {
      if (wanted) slots[bx] &= wanted[bx];
      in_row += slots[bx];
      before[stride + bx + 1] = before[bx + 1] + in_row;
      slots[bx] = slots[bx] ? used++ : kSoftNoSlot;
    }
    if (wanted) wanted += buffer.columns;
  }
  return used;
}

// ---- Drawing into them

struct ToSamples {
  static constexpr bool kSamples = true;
  SoftSamples* samples;
  SoftRows rows;
  int64_t margin;  // steps

  // Returns the triangles that reach a block with samples.
  HWY_INLINE M AtEdges(M triangles, V bx0, V by0, V bx1, V by1) const {
    if (hn::AllFalse(kFloats, triangles)) return triangles;
    const I columns = hn::Set(kInts, samples->columns + 1);
    const auto before = [&](V bx, V by) HWY_ATTR {
      const auto whole = [&](V v) HWY_ATTR {
        return hn::ConvertTo(kInts, hn::IfThenElseZero(triangles, v));
      };
      return hn::GatherIndex(kInts, samples->before.data(),
                             hn::Add(hn::Mul(whole(by), columns), whole(bx)));
    };
    const V one = Num(1), end_x = hn::Add(bx1, one), end_y = hn::Add(by1, one);
    const I inside = hn::Sub(hn::Sub(before(end_x, end_y), before(bx0, end_y)),
                             hn::Sub(before(end_x, by0), before(bx0, by0)));
    return hn::And(triangles, hn::RebindMask(kFloats, hn::Gt(inside, hn::Zero(kInts))));
  }
};

// Draws a triangle into the samples of one block. `e`: edge functions of each sample at the block's
// first pixel; `beside`: the largest difference of a sample from the centre.
struct SampledTriangle {
  V pixel[3][kSoftPixels / kLanes];  // contribution of the pixels to the edge functions
  V nearness, weight1, weight2, low, high;
  float beside[3];
  uint32_t id;

  HWY_INLINE SampledTriangle(const Batch& b, int i, uint32_t number)
      : nearness(Num(b.nearness[i])),
        weight1(Num(b.weight1[i])),
        weight2(Num(b.weight2[i])),
        low(Num(b.low[i])),
        high(Num(b.high[i])),
        id(number) {
    for (int k = 0; k < 3; ++k) {
      const float right = b.right[k][i], down = b.down[k][i];
      beside[k] = 0.5f * (std::abs(right) + std::abs(down)) + 1;
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        pixel[k][part / kLanes] = hn::Add(hn::Mul(Num(right), hn::Load(kFloats, kColumn + part)),
                                          hn::Mul(Num(down), hn::Load(kFloats, kRow + part)));
      }
    }
  }

  // `of_samples`: the differences from the edge functions `e` of the centre.
  HWY_INLINE void Draw(SoftSamples& samples, int32_t slot, const float* e,
                       const float (*of_samples)[3]) const {
    const V zero = hn::Zero(kFloats);
    for (int part = 0; part < kSoftPixels; part += kLanes) {
      const auto edge = [&](int k, float more)
                            HWY_ATTR { return hn::Add(Num(e[k] + more), pixel[k][part / kLanes]); };
      const V most = hn::Min(edge(0, beside[0]), hn::Min(edge(1, beside[1]), edge(2, beside[2])));
      if (hn::AllFalse(kFloats, hn::Ge(most, zero))) continue;
      for (int s = 0; s < samples.count; ++s) {
        const V e1 = edge(1, of_samples[s][1]), e2 = edge(2, of_samples[s][2]);
        const M covered = hn::Ge(hn::Min(edge(0, of_samples[s][0]), hn::Min(e1, e2)), zero);
        if (hn::AllFalse(kFloats, covered)) continue;
        const V q = hn::Add(nearness, hn::Add(hn::Mul(e1, weight1), hn::Mul(e2, weight2)));
        const size_t at = samples.At(slot, s);
        Put<true>(covered, hn::Min(hn::Max(q, low), high), id, part, samples.nearness[at].at,
                  samples.ids[at].at);
      }
    }
  }
};

// Edge functions of triangles that are set up in batches are whole numbers below 2^24: sums are
// exact in any order.
HWY_INLINE void DrawInBlocks(const Batch& b, int i, uint32_t id, const float* first,
                             const float (*of_samples)[3], const ToSamples& to) {
  SoftSamples& samples = *to.samples;
  const SampledTriangle triangle(b, i, id);
  const int begin = std::max(b.y0[i], to.rows.begin), end = std::min(b.y1[i] + 1, to.rows.end);
  for (int by = begin; by < end; ++by) {
    const int32_t* slots = samples.slots.data() + static_cast<size_t>(by) * samples.columns;
    const float dy = static_cast<float>(4 * (by - b.y0[i]));
    for (int bx = b.x0[i]; bx <= b.x1[i]; ++bx) {
      if (slots[bx] < 0) continue;
      const float dx = static_cast<float>(4 * (bx - b.x0[i]));
      float e[3];
      for (int k = 0; k < 3; ++k) e[k] = first[k] + (dx * b.right[k][i] + dy * b.down[k][i]);
      triangle.Draw(samples, slots[bx], e, of_samples);
    }
  }
}

HWY_INLINE void DrawSmall(const Batch& b, int i, uint32_t id, const ToSamples& to) {
  SoftSamples& samples = *to.samples;
  float first[3], of_samples[kSoftMostSamples][3];
  for (int k = 0; k < 3; ++k) {
    first[k] = b.e[0][k][i];
    for (int s = 0; s < samples.count; ++s) {
      of_samples[s][k] = samples.right[s] * b.right[k][i] + samples.down[s] * b.down[k][i];
    }
  }
  DrawInBlocks(b, i, id, first, of_samples, to);
}

HWY_INLINE void DrawMiddling(const SoftView& view, const Batch& b, int i, uint32_t id,
                             const ToSamples& to) {
  SoftSamples& samples = *to.samples;
  const int shift = __builtin_ctz(static_cast<unsigned>(view.steps));
  float first[3], of_samples[kSoftMostSamples][3];
  for (int k = 0; k < 3; ++k) {
    first[k] = WholeEdge(b, i, k, shift, 0, 0);
    for (int s = 0; s < samples.count; ++s) {
      const float there = WholeEdge(b, i, k, shift, static_cast<int>(samples.right[s] * view.steps),
                                    static_cast<int>(samples.down[s] * view.steps));
      of_samples[s][k] = there - first[k];
    }
  }
  DrawInBlocks(b, i, id, first, of_samples, to);
}

inline void DrawLarge(const SoftView& view, const Point* p, const PlaneNearness& plane, float low,
                      float high, uint32_t id, const ToSamples& to) {
  const LargeTriangle t = MakeLarge(view, p, to.margin);
  if (t.empty()) return;
  SoftSamples& samples = *to.samples;
  LargeRows row(t, 0.5);
  const V lowest = Num(low), highest = Num(high);
  const V near_right = Num(static_cast<float>(plane.right)),
          near_down = Num(static_cast<float>(plane.down));
  BlockEdges edges;
  double first[kSoftMostSamples][3];  // edge functions of the samples, in whole pixels
  for (int k = 0; k < 3; ++k) {
    edges.right[k] = static_cast<float>(row.right[k]);
    edges.down[k] = static_cast<float>(row.down[k]);
    for (int s = 0; s < samples.count; ++s) {
      const auto right = static_cast<int64_t>(samples.right[s] * view.steps),
                 down = static_cast<int64_t>(samples.down[s] * view.steps);
      first[s][k] = static_cast<double>((t.e[k] + t.dx[k] * right + t.dy[k] * down) >> t.shift);
    }
  }
  for (int by = t.y0; by <= t.y1; ++by) {
    row.Go(t, by);
    const int32_t* slots = samples.slots.data() + static_cast<size_t>(by) * samples.columns;
    for (int bx = row.begin; bx <= row.end; ++bx) {
      if (slots[bx] < 0) continue;
      const bool is_whole = bx >= row.whole_begin && bx <= row.whole_end;
      for (int s = 0; s < samples.count; ++s) {
        for (int k = 0; k < 3 && !is_whole; ++k) {
          edges.e[k] = EdgeNumber(first[s][k] + 4.0 * (by - t.y0) * row.down[k] +
                                  4.0 * (bx - t.x0) * row.right[k]);
        }
        const V origin =
            Num(static_cast<float>(plane.first + plane.down * (4 * by + samples.down[s]) +
                                   plane.right * (4 * bx + samples.right[s])));
        const size_t at = samples.At(slots[bx], s);
        for (int part = 0; part < kSoftPixels; part += kLanes) {
          M covered = hn::FirstN(kFloats, kLanes);
          if (!is_whole) {
            V unused1, unused2;
            covered = Inside(edges, part, &unused1, &unused2);
            if (hn::AllFalse(kFloats, covered)) continue;
          }
          const V q =
              hn::Add(origin, hn::Add(hn::Mul(near_right, hn::Load(kFloats, kColumn + part)),
                                      hn::Mul(near_down, hn::Load(kFloats, kRow + part))));
          Put<true>(covered, hn::Min(hn::Max(q, lowest), highest), id, part,
                    samples.nearness[at].at, samples.ids[at].at);
        }
      }
    }
  }
}

inline void DrawSamplesHere(const SoftView& view, const SoftInstance& instance,
                            SoftScratch* scratch, SoftSamples* samples) {
  // Samples are less than half a pixel from the centre.
  const ToSamples to{samples, BlockRows(view), static_cast<int64_t>(0.5f * view.steps)};
  DrawFacing(view, instance, Prepare(view, instance, to, scratch), scratch, to);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
