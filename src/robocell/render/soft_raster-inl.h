// Triangles into blocks of pixels; part of soft_kernel.cc, compiled for each instruction set.
#if defined(ROBOCELL_SOFT_RASTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_RASTER_INL_H_
#undef ROBOCELL_SOFT_RASTER_INL_H_
#else
#define ROBOCELL_SOFT_RASTER_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "robocell/render/soft_frame.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Registers of up to 16 pixels or triangles.
using Floats = hn::CappedTag<float, kSoftPixels>;
using Ints = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;
using I = hn::Vec<Ints>;
using M = hn::Mask<Floats>;
constexpr Floats kFloats;
constexpr Ints kInts;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(kFloats));

alignas(64) constexpr float kColumn[kSoftPixels] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
alignas(64) constexpr float kRow[kSoftPixels] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

// Rounded corners farther from the upper left pixel than this are clipped: edge functions of the
// others are exact.
constexpr float kReach = 1 << 20;
// The mark of a corner that must be clipped, and of one behind the camera's near plane.
constexpr float kBeyond = 4e9f, kBehind = -1;
// Triangles of at most this many steps on each side have exact edge functions in single precision:
// 10 pixels of 256 steps, 2 blocks and a rest.
constexpr float kSmall = 2560;
// Those of at most this many pixels on each side have exact ones in 32 bits.
constexpr float kMiddling = 28;

HWY_INLINE V Num(float value) { return hn::Set(kFloats, value); }

// One block and one triangle. Edge functions are those at the block's first pixel, then their steps
// to the right and down.
struct BlockEdges {
  float e[3], right[3], down[3];
};

HWY_INLINE M Inside(const BlockEdges& t, int part, V* e1, V* e2) {
  const V x = hn::Load(kFloats, kColumn + part), y = hn::Load(kFloats, kRow + part);
  const auto edge = [&](int k) HWY_ATTR {
    return hn::Add(Num(t.e[k]), hn::Add(hn::Mul(Num(t.right[k]), x), hn::Mul(Num(t.down[k]), y)));
  };
  *e1 = edge(1);
  *e2 = edge(2);
  return hn::Ge(hn::Min(edge(0), hn::Min(*e1, *e2)), hn::Zero(kFloats));
}

// Stores whole registers: the next triangle often meets the same block, and a processor hands on only
// what was stored whole.
template <bool kIds>
HWY_INLINE void Put(M covered, V nearness, uint32_t id, int part, float* at, uint32_t* ids) {
  const V before = hn::Load(kFloats, at + part);
  const M mask = hn::And(covered, hn::Ge(nearness, before));
  hn::Store(hn::IfThenElse(mask, nearness, before), kFloats, at + part);
  if constexpr (kIds) {
    auto* to = reinterpret_cast<int32_t*>(ids) + part;
    const I ids_before = hn::Load(kInts, to);
    hn::Store(hn::IfThenElse(hn::RebindMask(kInts, mask), hn::Set(kInts, static_cast<int32_t>(id)),
                             ids_before),
              kInts, to);
  }
}

// ---- Vertices

// Places the vertices from `begin` on, below `end`.
HWY_INLINE void PlaceVertices(const SoftView& view, const SoftInstance& instance, int begin,
                              int end, SoftScratch* scratch) {
  const SoftMesh& mesh = *instance.mesh;
  const float* m = instance.to_view;
  const float *xs = mesh.x.data(), *ys = mesh.y.data(), *zs = mesh.z.data();
  float *to_x = scratch->x.data(), *to_y = scratch->y.data(), *to_q = scratch->nearness.data();
  const bool orthographic = view.orthographic;
  const V near = Num(view.near), reach = Num(kReach), one = Num(1);
  const V steps = Num(view.steps), half = Num(0.5f), far = Num(view.far);
  const V range = Num(1 / (view.far - view.near));
  const V fx = Num(view.fx), fy = Num(view.fy), cx = Num(view.cx), cy = Num(view.cy);
  V rows[12];
  for (int k = 0; k < 12; ++k) rows[k] = Num(m[k]);
  for (int i = begin; i < end; i += kLanes) {
    const V x = hn::LoadU(kFloats, xs + i), y = hn::LoadU(kFloats, ys + i),
            z = hn::LoadU(kFloats, zs + i);
    const auto row = [&](int r) HWY_ATTR {
      return hn::Add(hn::Add(hn::Mul(rows[4 * r], x), hn::Mul(rows[4 * r + 1], y)),
                     hn::Add(hn::Mul(rows[4 * r + 2], z), rows[4 * r + 3]));
    };
    const V across = hn::Mul(fx, row(0)), up = hn::Mul(fy, row(1));
    const V depth = hn::Neg(row(2));
    const V shrink = orthographic ? one : hn::Div(one, depth);
    const V u = hn::Add(hn::Mul(across, shrink), cx), v = hn::Sub(cy, hn::Mul(up, shrink));
    const V px = hn::Round(hn::Mul(hn::Add(u, half), steps)),
            py = hn::Round(hn::Mul(hn::Add(v, half), steps));
    const V nearness = orthographic ? hn::Mul(hn::Sub(far, depth), range) : shrink;
    const M ahead = hn::Ge(depth, near);
    const M good = hn::And(ahead, hn::And(hn::Le(hn::Abs(px), reach), hn::Le(hn::Abs(py), reach)));
    hn::StoreU(hn::IfThenElse(good, px, Num(kBeyond)), kFloats, to_x + i);
    hn::StoreU(hn::IfThenElse(good, py, Num(kBeyond)), kFloats, to_y + i);
    hn::StoreU(hn::IfThenElse(ahead, nearness, Num(kBehind)), kFloats, to_q + i);
  }
}

// Adds those of the triangles from `begin` on, below `end`, that are turned to the camera to the
// list of `count`. Returns how many there are then.
HWY_INLINE int FindFacing(const SoftInstance& instance, int begin, int end, int count,
                          SoftScratch* scratch) {
  const SoftMesh& mesh = *instance.mesh;
  const float* facing[4];
  for (int k = 0; k < 4; ++k) facing[k] = mesh.facing[k].data();
  const int32_t* corners[3];
  int32_t* to[4] = {nullptr, nullptr, nullptr, scratch->facing.data()};
  for (int k = 0; k < 3; ++k) {
    corners[k] = mesh.corners[k].data();
    to[k] = scratch->corners[k].data();
  }
  const float sign = instance.side == SoftSide::kBack ? -1.0f : 1.0f;
  const V ex = Num(sign * instance.eye[0]), ey = Num(sign * instance.eye[1]),
          ez = Num(sign * instance.eye[2]), ew = Num(sign * instance.eye[3]);
  const bool all = instance.side == SoftSide::kBoth;
  for (int i = begin; i < end; i += kLanes) {
    const V a = hn::Add(hn::Mul(hn::LoadU(kFloats, facing[0] + i), ex),
                        hn::Mul(hn::LoadU(kFloats, facing[1] + i), ey));
    const V b = hn::Add(hn::Mul(hn::LoadU(kFloats, facing[2] + i), ez),
                        hn::Mul(hn::LoadU(kFloats, facing[3] + i), ew));
    M faces = hn::Gt(hn::Add(a, b), hn::Zero(kFloats));
    if (all) faces = hn::Eq(a, a);
    if (i + kLanes > end) faces = hn::And(faces, hn::FirstN(kFloats, static_cast<size_t>(end - i)));
    if (hn::AllFalse(kFloats, faces)) continue;
    // Whole registers are stored: some processors take long to store a part of one.
    const auto kept = hn::RebindMask(kInts, faces);
    hn::StoreU(hn::Compress(hn::Iota(kInts, i), kept), kInts, to[3] + count);
    for (int k = 0; k < 3; ++k) {
      hn::StoreU(hn::Compress(hn::LoadU(kInts, corners[k] + i), kept), kInts, to[k] + count);
    }
    count += static_cast<int>(hn::CountTrue(kInts, kept));
  }
  return count;
}

// How many times as long as in the mesh something may be in the view. A little more than 1 if
// the matrix only turns.
inline float LongestScale(const float* m) {
  float apart = 0, sum = 0;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      const float dot = m[a] * m[b] + m[4 + a] * m[4 + b] + m[8 + a] * m[8 + b];
      apart = std::max(apart, std::abs(dot - (a == b ? 1.0f : 0.0f)));
      if (a == b) sum += dot;
    }
  }
  return apart < 1e-4f ? 1.001f : std::sqrt(sum);
}

// Lists the clusters of which something may be seen.
template <class To>
HWY_INLINE int FindClusters(const SoftView& view, const SoftInstance& instance, const To& to,
                            SoftScratch* scratch) {
  const SoftClusters& clusters = instance.mesh->clusters;
  const float* m = instance.to_view;
  const float per = LongestScale(m);
  const V near = Num(view.near), far = Num(view.far), one = Num(1), zero = hn::Zero(kFloats);
  const V width = Num(static_cast<float>(view.width)), top = Num(static_cast<float>(view.top) - 2),
          bottom = Num(static_cast<float>(view.bottom) + 1);
  const V last_x = Num(static_cast<float>(view.width - 1)),
          last_y = Num(static_cast<float>(view.height - 1));
  int count = 0;
  for (int i = 0; i < clusters.count; i += kLanes) {
    const V x = hn::LoadU(kFloats, &clusters.x[i]), y = hn::LoadU(kFloats, &clusters.y[i]),
            z = hn::LoadU(kFloats, &clusters.z[i]),
            radius = hn::Mul(Num(per), hn::LoadU(kFloats, &clusters.radius[i]));
    const auto row = [&](int r) HWY_ATTR {
      return hn::Add(hn::Add(hn::Mul(Num(m[4 * r]), x), hn::Mul(Num(m[4 * r + 1]), y)),
                     hn::Add(hn::Mul(Num(m[4 * r + 2]), z), Num(m[4 * r + 3])));
    };
    const V right = row(0), up = row(1), depth = hn::Neg(row(2));
    const V nearest = hn::Sub(depth, radius), farthest = hn::Add(depth, radius);
    M seen = hn::And(hn::Ge(farthest, near), hn::Le(nearest, far));
    // Pixels between which the ball lies, if it is in front of the camera.
    const M ahead = hn::Gt(nearest, near);
    V per_nearest = one, per_farthest = one;
    if (!view.orthographic) {
      per_nearest = hn::Div(one, hn::IfThenElse(ahead, nearest, one));
      per_farthest = hn::Div(one, hn::IfThenElse(ahead, farthest, one));
    }
    const auto least = [&](V v) HWY_ATTR {
      return hn::Min(hn::Mul(v, per_nearest), hn::Mul(v, per_farthest));
    };
    const auto most = [&](V v) HWY_ATTR {
      return hn::Max(hn::Mul(v, per_nearest), hn::Mul(v, per_farthest));
    };
    const V fx = Num(view.fx), fy = Num(view.fy), cx = Num(view.cx), cy = Num(view.cy);
    const V low_x = hn::Sub(hn::Add(hn::Mul(fx, least(hn::Sub(right, radius))), cx), one),
            high_x = hn::Add(hn::Add(hn::Mul(fx, most(hn::Add(right, radius))), cx), one);
    const V low_y = hn::Sub(hn::Sub(cy, hn::Mul(fy, most(hn::Add(up, radius)))), one),
            high_y = hn::Add(hn::Sub(cy, hn::Mul(fy, least(hn::Sub(up, radius)))), one);
    const M on_image = hn::And(hn::And(hn::Ge(high_x, Num(-1)), hn::Le(low_x, width)),
                               hn::And(hn::Ge(high_y, top), hn::Le(low_y, bottom)));
    seen = hn::And(seen, hn::Or(hn::Not(ahead), on_image));
    if (i + kLanes > clusters.count) {
      seen = hn::And(seen, hn::FirstN(kFloats, static_cast<size_t>(clusters.count - i)));
    }
    if constexpr (To::kSamples) {
      const M known = hn::And(seen, ahead);
      const auto block = [&](V at, V last) HWY_ATTR {
        return hn::Floor(hn::Mul(hn::Min(hn::Max(at, zero), last), Num(0.25f)));
      };
      seen = hn::Or(hn::AndNot(ahead, seen),
                    to.AtEdges(known, block(low_x, last_x), block(low_y, last_y),
                               block(high_x, last_x), block(high_y, last_y)));
    }
    if (hn::AllFalse(kFloats, seen)) continue;
    const auto kept = hn::RebindMask(kInts, seen);
    hn::StoreU(hn::Compress(hn::Iota(kInts, i), kept), kInts, &scratch->clusters[count]);
    count += static_cast<int>(hn::CountTrue(kInts, kept));
  }
  return count;
}

// Places the vertices of what may be seen and lists the triangles of it that are turned to the
// camera. Returns how many there are.
template <class To>
HWY_INLINE int Prepare(const SoftView& view, const SoftInstance& instance, const To& to,
                       SoftScratch* scratch) {
  const SoftMesh& mesh = *instance.mesh;
  const SoftClusters& clusters = mesh.clusters;
  if (clusters.count == 0) {
    PlaceVertices(view, instance, 0, mesh.vertices, scratch);
    return FindFacing(instance, 0, mesh.triangles, 0, scratch);
  }
  const int seen = FindClusters(view, instance, to, scratch);
  uint8_t* groups = scratch->groups.data();
  const int last = (mesh.vertices - 1) / SoftClusters::kVertices;
  std::fill_n(groups, last + 1, uint8_t{0});
  int count = 0;
  for (int k = 0; k < seen; ++k) {
    const int cluster = scratch->clusters[k];
    const int begin = SoftClusters::kTriangles * cluster;
    const int before = count;
    count = FindFacing(instance, begin, std::min(begin + SoftClusters::kTriangles, mesh.triangles),
                       count, scratch);
    if (count == before) continue;
    const int first_group = clusters.first_group[cluster];
    std::fill_n(groups + first_group, clusters.last_group[cluster] - first_group + 1, uint8_t{1});
  }
  for (int group = 0; group <= last; ++group) {
    if (!groups[group]) continue;
    int end = group;
    while (end < last && groups[end + 1]) ++end;
    PlaceVertices(view, instance, SoftClusters::kVertices * group,
                  std::min(SoftClusters::kVertices * (end + 1), mesh.vertices), scratch);
    group = end;
  }
  return count;
}

// ---- Large triangles, one at a time

// Nearness on a plane: at the first pixel of the image, and its steps.
struct PlaneNearness {
  double first = 0, right = 0, down = 0;
};

// Returns the nearness of the plane n . p = c in view axes.
inline PlaneNearness NearnessOf(const SoftView& view, const double n[3], double c) {
  const double x = n[0] / view.fx, y = -n[1] / view.fy;
  double at = -(x * view.cx + y * view.cy);  // of n.x x + n.y y at pixel (0, 0), depth 1
  if (!view.orthographic) return {(at - n[2]) / c, x / c, y / c};
  const double range = 1.0 / (static_cast<double>(view.far) - view.near);
  return {(view.far - (at - c) / n[2]) * range, -x / n[2] * range, -y / n[2] * range};
}

struct Point {
  int64_t x, y;
};

// A large triangle: the blocks around it, and its edge functions at the centre of the first pixel
// of the first block, in steps.
struct LargeTriangle {
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;
  int shift = 0;  // a pixel has this power of two of steps
  int64_t e[3], dx[3], dy[3];

  bool empty() const { return x1 < x0 || y1 < y0; }
};

// `margin`: how many steps beside a pixel's centre the triangle is still visible.
inline LargeTriangle MakeLarge(const SoftView& view, const Point* p, int64_t margin) {
  LargeTriangle t;
  const auto steps = static_cast<int64_t>(view.steps);
  const int64_t half = steps / 2;
  t.shift = __builtin_ctzll(static_cast<uint64_t>(steps));
  const auto up = [&](int64_t at) {
    return static_cast<int>((at - margin - half + steps - 1) >> t.shift);
  };
  const auto down = [&](int64_t at) { return static_cast<int>((at + margin - half) >> t.shift); };
  t.x0 = std::max(0, up(std::min({p[0].x, p[1].x, p[2].x}))) / kSoftBlock;
  t.y0 = std::max(view.top, up(std::min({p[0].y, p[1].y, p[2].y}))) / kSoftBlock;
  const int last_x = std::min(view.width - 1, down(std::max({p[0].x, p[1].x, p[2].x})));
  const int last_y = std::min(view.bottom - 1, down(std::max({p[0].y, p[1].y, p[2].y})));
  if (last_x < t.x0 * kSoftBlock || last_y < t.y0 * kSoftBlock) return t;
  t.x1 = last_x / kSoftBlock;
  t.y1 = last_y / kSoftBlock;
  const int64_t ox = t.x0 * kSoftBlock * steps + half, oy = t.y0 * kSoftBlock * steps + half;
  for (int k = 0; k < 3; ++k) {
    const Point &a = p[(k + 2) % 3], &b = p[(k + 1) % 3];
    t.dx[k] = a.y - b.y;
    t.dy[k] = b.x - a.x;
    const bool inclusive = t.dx[k] > 0 || (t.dx[k] == 0 && t.dy[k] > 0);
    t.e[k] = (a.x - ox) * (b.y - oy) - (a.y - oy) * (b.x - ox) - (inclusive ? 0 : 1);
  }
  return t;
}

// The blocks of a row between the edges of a large triangle. Edge functions are in whole pixels:
// the fraction that the shift removes decides nothing.
struct LargeRows {
  double first[3], right[3], down[3];
  double e[3];                 // at the row's first block
  int begin, end;              // blocks that may be covered in part
  int whole_begin, whole_end;  // those that are covered certainly

  // `beside`: how many pixels beside the centres the triangle is still visible.
  LargeRows(const LargeTriangle& t, double beside) {
    // Blocks at limits that are uncertain by rounding count as partly covered. Limits that an edge
    // does not set are farther away than any image.
    constexpr double kDoubt = 1e-3, kNone = -1e6;
    for (int k = 0; k < 3; ++k) {
      first[k] = static_cast<double>(t.e[k] >> t.shift);
      right[k] = static_cast<double>(t.dx[k]);
      down[k] = static_cast<double>(t.dy[k]);
      const double more = beside * (std::abs(right[k]) + std::abs(down[k]));
      // The largest and smallest change within a block.
      const double most =
          first[k] + std::max(0.0, 3 * right[k]) + std::max(0.0, 3 * down[k]) + more;
      const double least =
          first[k] + std::min(0.0, 3 * right[k]) + std::min(0.0, 3 * down[k]) - more;
      std::fill_n(limit_[k], 4, kNone);
      std::fill_n(step_[k], 4, 0.0);
      const auto set = [&](int which, double at, double scale, double doubt) {
        limit_[k][which] = at * scale + doubt;
        step_[k][which] = 4 * down[k] * scale;
      };
      if (right[k] > 0) {
        set(0, most, -0.25 / right[k], -kDoubt);
        set(2, least, -0.25 / right[k], kDoubt);
      } else if (right[k] < 0) {
        set(1, most, 0.25 / right[k], -kDoubt);
        set(3, least, 0.25 / right[k], kDoubt);
      } else {  // all of the row or nothing
        set(1, most + 0.5, kNone, 0);
        set(3, least + 0.5, kNone, 0);
      }
    }
    widest_[0] = widest_[2] = 0;
    widest_[1] = widest_[3] = t.x0 - t.x1;
  }

  HWY_INLINE void Go(const LargeTriangle& t, int by) {
    constexpr hn::CappedTag<double, 4> doubles;
    const hn::Rebind<int32_t, decltype(doubles)> ints;
    const auto down_rows = hn::Set(doubles, static_cast<double>(by - t.y0));
    alignas(32) int32_t limits[4];
    for (size_t i = 0; i < 4; i += hn::Lanes(doubles)) {
      auto most = hn::Load(doubles, widest_ + i);
      for (int k = 0; k < 3; ++k) {
        most = hn::Max(most, hn::Add(hn::Load(doubles, limit_[k] + i),
                                     hn::Mul(down_rows, hn::Load(doubles, step_[k] + i))));
      }
      hn::StoreU(hn::DemoteTo(ints, hn::Min(hn::Ceil(most), hn::Set(doubles, 1e6))), ints,
                 limits + i);
    }
    for (int k = 0; k < 3; ++k) e[k] = first[k] + 4.0 * (by - t.y0) * down[k];
    begin = t.x0 + limits[0];
    end = t.x0 - limits[1];
    whole_begin = t.x0 + limits[2];
    whole_end = t.x0 - limits[3];
    if (whole_begin > whole_end) whole_begin = whole_end = end + 1;
  }

 private:
  // First block, last one with the other sign, and those of the fully covered ones.
  alignas(32) double limit_[3][4];
  alignas(32) double step_[3][4];
  alignas(32) double widest_[4];
};

HWY_INLINE float EdgeNumber(double e) {
  return static_cast<float>(std::min(std::max(e, -16777216.0), 16777216.0));
}

// The target of drawing at centres. soft_samples-inl.h has the other one.
template <bool kIds>
struct ToCentres {
  static constexpr bool kSamples = false;
  SoftBuffer* buffer;
  SoftRows rows;

  HWY_INLINE void Prefetch(int bx, int by) const {
    const size_t block = static_cast<size_t>(by) * buffer->columns + bx;
    hwy::Prefetch(&buffer->nearness[block]);
    if constexpr (kIds) hwy::Prefetch(&buffer->ids[block]);
  }
};

template <bool kIds>
void DrawLarge(const SoftView& view, const Point* p, const PlaneNearness& plane, float low,
               float high, uint32_t id, const ToCentres<kIds>& to) {
  const LargeTriangle t = MakeLarge(view, p, 0);
  if (t.empty()) return;
  LargeRows row(t, 0);
  const V lowest = Num(low), highest = Num(high);
  const V near_right = Num(static_cast<float>(plane.right)),
          near_down = Num(static_cast<float>(plane.down));
  const auto step = [&](int part) HWY_ATTR {
    return hn::Add(hn::Mul(near_right, hn::Load(kFloats, kColumn + part)),
                   hn::Mul(near_down, hn::Load(kFloats, kRow + part)));
  };
  BlockEdges edges;
  for (int k = 0; k < 3; ++k) {
    edges.right[k] = static_cast<float>(row.right[k]);
    edges.down[k] = static_cast<float>(row.down[k]);
  }
  SoftBuffer* buffer = to.buffer;
  for (int by = t.y0; by <= t.y1; ++by) {
    row.Go(t, by);
    const size_t blocks = static_cast<size_t>(by) * buffer->columns;
    const double start = plane.first + plane.down * (by * 4);
    const auto some = [&](int begin, int end) HWY_ATTR {
      for (int bx = begin; bx < end; ++bx) {
        for (int k = 0; k < 3; ++k) {
          edges.e[k] = EdgeNumber(row.e[k] + 4.0 * (bx - t.x0) * row.right[k]);
        }
        const V origin = Num(static_cast<float>(start + plane.right * (4 * bx)));
        float* at = buffer->nearness[blocks + bx].at;
        uint32_t* ids = kIds ? buffer->ids[blocks + bx].at : nullptr;
        for (int part = 0; part < kSoftPixels; part += kLanes) {
          V unused1, unused2;
          const M covered = Inside(edges, part, &unused1, &unused2);
          if (hn::AllFalse(kFloats, covered)) continue;
          const V q = hn::Add(origin, step(part));
          Put<kIds>(covered, hn::Min(hn::Max(q, lowest), highest), id, part, at, ids);
        }
      }
    };
    some(row.begin, std::min(row.whole_begin, row.end + 1));
    for (int bx = row.whole_begin; bx <= std::min(row.whole_end, row.end); ++bx) {
      const V origin = Num(static_cast<float>(start + plane.right * (4 * bx)));
      float* at = buffer->nearness[blocks + bx].at;
      uint32_t* ids = kIds ? buffer->ids[blocks + bx].at : nullptr;
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        const V q = hn::Add(origin, step(part));
        Put<kIds>(hn::FirstN(kFloats, kLanes), hn::Min(hn::Max(q, lowest), highest), id, part, at,
                  ids);
      }
    }
    some(std::max(row.begin, row.whole_end + 1), row.end + 1);
  }
}

struct ViewPoint {
  double x, y, z;  // view axes
};

inline ViewPoint InView(const SoftInstance& instance, int vertex) {
  const SoftMesh& mesh = *instance.mesh;
  const float* m = instance.to_view;
  const double x = mesh.x[vertex], y = mesh.y[vertex], z = mesh.z[vertex];
  return {m[0] * x + m[1] * y + m[2] * z + m[3], m[4] * x + m[5] * y + m[6] * z + m[7],
          m[8] * x + m[9] * y + m[10] * z + m[11]};
}

// Returns true if the plane exists.
inline bool PlaneOf(const SoftView& view, const ViewPoint* p, PlaneNearness* plane) {
  const double u[3] = {p[1].x - p[0].x, p[1].y - p[0].y, p[1].z - p[0].z};
  const double v[3] = {p[2].x - p[0].x, p[2].y - p[0].y, p[2].z - p[0].z};
  const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                       u[0] * v[1] - u[1] * v[0]};
  const double c = n[0] * p[0].x + n[1] * p[0].y + n[2] * p[0].z;
  if ((view.orthographic ? n[2] : c) == 0) return false;
  *plane = NearnessOf(view, n, c);
  return true;
}

inline float NearnessAt(const SoftView& view, double depth) {
  return static_cast<float>(view.orthographic
                                ? (view.far - depth) / (static_cast<double>(view.far) - view.near)
                                : 1 / depth);
}

// Orders the corners such that the inside is positive. Returns true if the triangle is drawn at
// all.
inline bool Orient(SoftSide side, Point* p) {
  const int64_t area =
      (p[2].x - p[0].x) * (p[1].y - p[0].y) - (p[2].y - p[0].y) * (p[1].x - p[0].x);
  if (area == 0) return false;
  const bool front = area > 0;
  if (side != SoftSide::kBoth && front != (side == SoftSide::kFront)) return false;
  if (!front) std::swap(p[1], p[2]);
  return true;
}

// Draws a triangle that reaches out of the drawable range, part of which may be visible.
template <class To>
void DrawCut(const SoftView& view, const SoftInstance& instance, int triangle, const To& to) {
  constexpr int kMost = 9;
  ViewPoint polygon[kMost], cut[kMost];
  int count = 3;
  for (int k = 0; k < 3; ++k) {
    polygon[k] = InView(instance, instance.mesh->corners[k][triangle]);
  }
  PlaneNearness plane;
  if (!PlaneOf(view, polygon, &plane)) return;
  // The range is slightly smaller than that of exact edge functions.
  const double reach = 0.99 * kReach / view.steps;
  const auto distance = [&](int side, const ViewPoint& p) {
    if (side == 0) return -p.z - view.near;
    const double scale = view.orthographic ? 1 : -p.z;
    switch (side) {
      case 1:
        return p.x * view.fx + (view.cx + reach) * scale;
      case 2:
        return (reach - view.cx) * scale - p.x * view.fx;
      case 3:
        return (view.cy + reach) * scale - p.y * view.fy;
      default:
        return p.y * view.fy + (reach - view.cy) * scale;
    }
  };
  for (int side = 0; side < 5 && count >= 3; ++side) {
    int kept = 0;
    for (int k = 0; k < count; ++k) {
      const ViewPoint &a = polygon[k], &b = polygon[(k + 1) % count];
      const double da = distance(side, a), db = distance(side, b);
      if (da >= 0) cut[kept++] = a;
      if ((da >= 0) != (db >= 0)) {
        const double t = da / (da - db);
        cut[kept++] = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
      }
    }
    count = kept;
    std::copy_n(cut, count, polygon);
  }
  if (count < 3) return;
  Point points[kMost];
  float low = NearnessAt(view, -polygon[0].z), high = low;
  for (int k = 0; k < count; ++k) {
    const double shrink = view.orthographic ? 1 : -1 / polygon[k].z;
    points[k] = {std::llrint((polygon[k].x * view.fx * shrink + view.cx + 0.5) * view.steps),
                 std::llrint((view.cy - polygon[k].y * view.fy * shrink + 0.5) * view.steps)};
    const float nearness = NearnessAt(view, -polygon[k].z);
    low = std::min(low, nearness);
    high = std::max(high, nearness);
  }
  for (int k = 1; k + 1 < count; ++k) {
    Point p[3] = {points[0], points[k], points[k + 1]};
    if (!Orient(instance.side, p)) continue;
    DrawLarge(view, p, plane, low, high, instance.first_id + triangle, to);
  }
}

// ---- Small triangles, a register at a time

struct alignas(64) Batch {
  // Of small ones the edge functions are those at the first pixel of each of their four blocks.
  static constexpr int kBlocks = 4;
  float e[kBlocks][3][kSoftPixels], right[3][kSoftPixels], down[3][kSoftPixels];
  float nearness[kSoftPixels], weight1[kSoftPixels], weight2[kSoftPixels];
  float low[kSoftPixels], high[kSoftPixels];
  float x[3][kSoftPixels], y[3][kSoftPixels];
  int32_t x0[kSoftPixels], x1[kSoftPixels], y0[kSoftPixels],
      y1[kSoftPixels];                  // blocks
  int32_t block[kBlocks][kSoftPixels];  // where those of a small one are in the buffer
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
  // How a triangle is drawn must not depend on the rows.
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
      // Which of its blocks a small one may meet.
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
        // What a block's pixels add at most.
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
    // Draws in the order of the mesh, whatever the sizes: of triangles at one place the last is
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
