// Triangles into blocks of pixels; part of soft_kernel.cc, compiled for each instruction set.
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

// Rounded corners farther from the upper left pixel than this are cut off: edge functions of the
// others are exact.
constexpr float kReach = 1 << 20;
// What stands for a corner that must be cut off, and for one behind the camera's near plane.
constexpr float kBeyond = 4e9f, kBehind = -1;
// Triangles of at most this many steps on each side have exact edge functions in single precision:
// 10 pixels of 256 steps, 2 blocks and a rest.
constexpr float kSmall = 2560;

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

template <bool kIds>
HWY_INLINE void Put(M covered, V nearness, uint32_t id, int part, float* at, uint32_t* ids) {
  const M mask = hn::And(covered, hn::Ge(nearness, hn::Load(kFloats, at + part)));
  hn::BlendedStore(nearness, mask, kFloats, at + part);
  if constexpr (kIds) {
    hn::BlendedStore(hn::Set(kInts, static_cast<int32_t>(id)), hn::RebindMask(kInts, mask), kInts,
                     reinterpret_cast<int32_t*>(ids) + part);
  }
}

// ---- Vertices

HWY_INLINE void PlaceVertices(const SoftView& view, const SoftInstance& instance,
                              SoftScratch* scratch) {
  const SoftMesh& mesh = *instance.mesh;
  const float* m = instance.to_view;
  const V near = Num(view.near), reach = Num(kReach), one = Num(1);
  const V steps = Num(view.steps), half = Num(0.5f), far = Num(view.far);
  const V range = Num(1 / (view.far - view.near));
  for (int i = 0; i < mesh.vertices; i += kLanes) {
    const V x = hn::LoadU(kFloats, &mesh.x[i]), y = hn::LoadU(kFloats, &mesh.y[i]),
            z = hn::LoadU(kFloats, &mesh.z[i]);
    const auto row = [&](int r) HWY_ATTR {
      return hn::Add(hn::Add(hn::Mul(Num(m[4 * r]), x), hn::Mul(Num(m[4 * r + 1]), y)),
                     hn::Add(hn::Mul(Num(m[4 * r + 2]), z), Num(m[4 * r + 3])));
    };
    const V across = hn::Mul(Num(view.fx), row(0)), up = hn::Mul(Num(view.fy), row(1));
    const V depth = hn::Neg(row(2));
    const V shrink = view.orthographic ? one : hn::Div(one, depth);
    const V u = hn::Add(hn::Mul(across, shrink), Num(view.cx)),
            v = hn::Sub(Num(view.cy), hn::Mul(up, shrink));
    const V px = hn::Round(hn::Mul(hn::Add(u, half), steps)),
            py = hn::Round(hn::Mul(hn::Add(v, half), steps));
    const V nearness = view.orthographic ? hn::Mul(hn::Sub(far, depth), range) : shrink;
    const M ahead = hn::Ge(depth, near);
    const M good = hn::And(ahead, hn::And(hn::Le(hn::Abs(px), reach), hn::Le(hn::Abs(py), reach)));
    hn::StoreU(hn::IfThenElse(good, px, Num(kBeyond)), kFloats, &scratch->x[i]);
    hn::StoreU(hn::IfThenElse(good, py, Num(kBeyond)), kFloats, &scratch->y[i]);
    hn::StoreU(hn::IfThenElse(ahead, nearness, Num(kBehind)), kFloats, &scratch->nearness[i]);
  }
}

// Lists the triangles that are turned to the camera.
HWY_INLINE int FindFacing(const SoftInstance& instance, SoftScratch* scratch) {
  const SoftMesh& mesh = *instance.mesh;
  int count = 0;
  const float sign = instance.side == SoftSide::kBack ? -1.0f : 1.0f;
  const V ex = Num(sign * instance.eye[0]), ey = Num(sign * instance.eye[1]),
          ez = Num(sign * instance.eye[2]), ew = Num(sign * instance.eye[3]);
  const bool all = instance.side == SoftSide::kBoth;
  for (int i = 0; i < mesh.triangles; i += kLanes) {
    const V a = hn::Add(hn::Mul(hn::LoadU(kFloats, &mesh.facing[0][i]), ex),
                        hn::Mul(hn::LoadU(kFloats, &mesh.facing[1][i]), ey));
    const V b = hn::Add(hn::Mul(hn::LoadU(kFloats, &mesh.facing[2][i]), ez),
                        hn::Mul(hn::LoadU(kFloats, &mesh.facing[3][i]), ew));
    M faces = hn::Gt(hn::Add(a, b), hn::Zero(kFloats));
    if (all) faces = hn::Eq(a, a);
    if (i + kLanes > mesh.triangles)
      faces = hn::And(faces, hn::FirstN(kFloats, mesh.triangles - i));
    count += static_cast<int>(hn::CompressStore(hn::Iota(kInts, i), hn::RebindMask(kInts, faces),
                                                kInts, &scratch->facing[count]));
  }
  return count;
}

// ---- Large triangles, one at a time

// Nearness on a plane: at the first pixel of the image, and its steps.
struct PlaneNearness {
  double first = 0, right = 0, down = 0;
};

// The plane n . p = c in view axes.
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

inline int64_t FloorDivide(int64_t a, int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

template <bool kIds>
void DrawLarge(const SoftView& view, const Point* p, const PlaneNearness& plane, float low,
               float high, uint32_t id, SoftBuffer* buffer) {
  const auto steps = static_cast<int64_t>(view.steps);
  const int64_t half = steps / 2;
  const auto pixel_up = [&](int64_t at) {
    return static_cast<int>(FloorDivide(at - half + steps - 1, steps));
  };
  const auto pixel_down = [&](int64_t at) {
    return static_cast<int>(FloorDivide(at - half, steps));
  };
  const int x0 = std::max(0, pixel_up(std::min({p[0].x, p[1].x, p[2].x}))) / kSoftBlock;
  const int y0 = std::max(0, pixel_up(std::min({p[0].y, p[1].y, p[2].y}))) / kSoftBlock;
  const int last_x = std::min(view.width - 1, pixel_down(std::max({p[0].x, p[1].x, p[2].x})));
  const int last_y = std::min(view.height - 1, pixel_down(std::max({p[0].y, p[1].y, p[2].y})));
  if (last_x < x0 * kSoftBlock || last_y < y0 * kSoftBlock) return;
  const int x1 = last_x / kSoftBlock, y1 = last_y / kSoftBlock;

  // Edge functions in whole pixels: the fraction that the floor takes away decides nothing.
  int64_t first[3];
  double right[3], down[3], most[3], least[3];
  for (int k = 0; k < 3; ++k) {
    const Point &a = p[(k + 2) % 3], &b = p[(k + 1) % 3];
    const int64_t dx = a.y - b.y, dy = b.x - a.x;
    const int64_t ox = x0 * kSoftBlock * steps + half, oy = y0 * kSoftBlock * steps + half;
    const int64_t e = (a.x - ox) * (b.y - oy) - (a.y - oy) * (b.x - ox);
    const bool inclusive = dx > 0 || (dx == 0 && dy > 0);
    first[k] = FloorDivide(e - (inclusive ? 0 : 1), steps);
    right[k] = static_cast<double>(dx);
    down[k] = static_cast<double>(dy);
    most[k] = std::max(0.0, 3 * right[k]) + std::max(0.0, 3 * down[k]);
    least[k] = std::min(0.0, 3 * right[k]) + std::min(0.0, 3 * down[k]);
  }
  const V lowest = Num(low), highest = Num(high);
  const V near_right = Num(static_cast<float>(plane.right)),
          near_down = Num(static_cast<float>(plane.down));
  BlockEdges edges;
  for (int k = 0; k < 3; ++k) {
    edges.right[k] = static_cast<float>(right[k]);
    edges.down[k] = static_cast<float>(down[k]);
  }
  for (int by = y0; by <= y1; ++by) {
    double e[3];
    int begin = x0, end = x1;
    for (int k = 0; k < 3; ++k) {
      e[k] = static_cast<double>(first[k]) + 4.0 * (by - y0) * down[k];
      const double reach = e[k] + most[k];  // the largest in the row's first block
      if (right[k] > 0) {
        if (reach < 0)
          begin = std::max(
              begin, x0 + static_cast<int>(std::min(1e6, std::ceil(-reach / (4 * right[k])))));
      } else if (right[k] < 0) {
        end = reach < 0 ? -1
                        : std::min(end, x0 + static_cast<int>(std::min(
                                                 1e6, std::floor(reach / (-4 * right[k])))));
      } else if (reach < 0) {
        end = -1;
      }
    }
    if (begin > end) continue;
    for (int k = 0; k < 3; ++k) e[k] += 4.0 * (begin - x0) * right[k];
    double start = plane.first + plane.down * (by * 4) + plane.right * (begin * 4);
    size_t block = static_cast<size_t>(by) * buffer->columns + begin;
    for (int bx = begin; bx <= end; ++bx, ++block) {
      float* at = buffer->nearness[block].at;
      uint32_t* ids = kIds ? buffer->ids[block].at : nullptr;
      const bool whole = e[0] + least[0] >= 0 && e[1] + least[1] >= 0 && e[2] + least[2] >= 0;
      if (!whole) {
        for (int k = 0; k < 3; ++k) {
          edges.e[k] = static_cast<float>(std::clamp(e[k], -16777216.0, 16777216.0));
        }
      }
      for (int k = 0; k < 3; ++k) e[k] += 4 * right[k];
      const V origin = Num(static_cast<float>(start));
      start += 4 * plane.right;
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        M covered = hn::Eq(origin, origin);
        if (!whole) {
          V unused1, unused2;
          covered = Inside(edges, part, &unused1, &unused2);
          if (hn::AllFalse(kFloats, covered)) continue;
        }
        const V q = hn::Add(origin, hn::Add(hn::Mul(near_right, hn::Load(kFloats, kColumn + part)),
                                            hn::Mul(near_down, hn::Load(kFloats, kRow + part))));
        Put<kIds>(covered, hn::Min(hn::Max(q, lowest), highest), id, part, at, ids);
      }
    }
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

// Whether there is a plane.
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

// Turns the corners so that the inside is positive. Whether it is to be drawn at all.
inline bool Orient(SoftSide side, Point* p) {
  const int64_t area =
      (p[2].x - p[0].x) * (p[1].y - p[0].y) - (p[2].y - p[0].y) * (p[1].x - p[0].x);
  if (area == 0) return false;
  const bool front = area > 0;
  if (side != SoftSide::kBoth && front != (side == SoftSide::kFront)) return false;
  if (!front) std::swap(p[1], p[2]);
  return true;
}

// A triangle that reaches out of the drawable range, part of which may be seen.
template <bool kIds>
void DrawCut(const SoftView& view, const SoftInstance& instance, int triangle, SoftBuffer* buffer) {
  constexpr int kMost = 9;
  ViewPoint polygon[kMost], cut[kMost];
  int count = 3;
  for (int k = 0; k < 3; ++k) {
    polygon[k] = InView(instance, instance.mesh->corners[3 * triangle + k]);
  }
  PlaneNearness plane;
  if (!PlaneOf(view, polygon, &plane)) return;
  // The range is a little smaller than what edge functions are exact in.
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
    DrawLarge<kIds>(view, p, plane, low, high, instance.first_id + triangle, buffer);
  }
}

// ---- Small triangles, a register at a time

struct alignas(64) Batch {
  float e[3][kSoftPixels], right[3][kSoftPixels], down[3][kSoftPixels];
  float nearness[kSoftPixels], weight1[kSoftPixels], weight2[kSoftPixels];
  float low[kSoftPixels], high[kSoftPixels];
  float x[3][kSoftPixels], y[3][kSoftPixels];
  int32_t x0[kSoftPixels], x1[kSoftPixels], y0[kSoftPixels], y1[kSoftPixels];  // blocks
  int32_t triangle[kSoftPixels];
};

template <bool kIds>
HWY_INLINE void DrawSmall(const Batch& b, int i, uint32_t id, SoftBuffer* buffer) {
  const V nearness = Num(b.nearness[i]), weight1 = Num(b.weight1[i]), weight2 = Num(b.weight2[i]);
  const V low = Num(b.low[i]), high = Num(b.high[i]);
  BlockEdges edges;
  for (int k = 0; k < 3; ++k) {
    edges.right[k] = b.right[k][i];
    edges.down[k] = b.down[k][i];
  }
  for (int by = b.y0[i]; by <= b.y1[i]; ++by) {
    for (int bx = b.x0[i]; bx <= b.x1[i]; ++bx) {
      const float dx = static_cast<float>(4 * (bx - b.x0[i])),
                  dy = static_cast<float>(4 * (by - b.y0[i]));
      for (int k = 0; k < 3; ++k) {
        edges.e[k] = b.e[k][i] + (dx * edges.right[k] + dy * edges.down[k]);
      }
      const size_t block = static_cast<size_t>(by) * buffer->columns + bx;
      float* at = buffer->nearness[block].at;
      uint32_t* ids = kIds ? buffer->ids[block].at : nullptr;
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        V e1, e2;
        const M covered = Inside(edges, part, &e1, &e2);
        if (hn::AllFalse(kFloats, covered)) continue;
        const V q = hn::Add(nearness, hn::Add(hn::Mul(e1, weight1), hn::Mul(e2, weight2)));
        Put<kIds>(covered, hn::Min(hn::Max(q, low), high), id, part, at, ids);
      }
    }
  }
}

template <bool kIds>
HWY_INLINE void DrawFacing(const SoftView& view, const SoftInstance& instance, int count,
                           SoftScratch* scratch, SoftBuffer* buffer) {
  const SoftMesh& mesh = *instance.mesh;
  const float *px = scratch->x.data(), *py = scratch->y.data(), *pq = scratch->nearness.data();
  const int32_t* corners = mesh.corners.data();
  const V zero = hn::Zero(kFloats), half = Num(0.5f * view.steps), per_step = Num(1 / view.steps);
  const V steps = Num(view.steps);
  const V last_x = Num(static_cast<float>(view.width - 1)),
          last_y = Num(static_cast<float>(view.height - 1));
  const SoftSide side = instance.side;
  int cut = 0;
  Batch b;
  // The last register is filled up with the last triangle.
  for (int k = 0; k < kLanes; ++k)
    scratch->facing[count + k] = count ? scratch->facing[count - 1] : 0;
  for (int i = 0; i < count; i += kLanes) {
    const I triangle = hn::LoadU(kInts, &scratch->facing[i]);
    const I at = hn::Add(triangle, hn::Add(triangle, triangle));
    const I i0 = hn::GatherIndex(kInts, corners, at), i1 = hn::GatherIndex(kInts, corners + 1, at),
            i2 = hn::GatherIndex(kInts, corners + 2, at);
    const V x0 = hn::GatherIndex(kFloats, px, i0), y0 = hn::GatherIndex(kFloats, py, i0);
    V x1 = hn::GatherIndex(kFloats, px, i1), y1 = hn::GatherIndex(kFloats, py, i1);
    V x2 = hn::GatherIndex(kFloats, px, i2), y2 = hn::GatherIndex(kFloats, py, i2);
    const V low_x = hn::Min(x0, hn::Min(x1, x2)), high_x = hn::Max(x0, hn::Max(x1, x2));
    const V low_y = hn::Min(y0, hn::Min(y1, y2)), high_y = hn::Max(y0, hn::Max(y1, y2));
    const V first_x = hn::Max(zero, hn::Ceil(hn::Mul(hn::Sub(low_x, half), per_step)));
    const V first_y = hn::Max(zero, hn::Ceil(hn::Mul(hn::Sub(low_y, half), per_step)));
    const V end_x = hn::Min(last_x, hn::Floor(hn::Mul(hn::Sub(high_x, half), per_step)));
    const V end_y = hn::Min(last_y, hn::Floor(hn::Mul(hn::Sub(high_y, half), per_step)));
    const M beyond = hn::Gt(high_x, Num(kReach));
    M seen = hn::And(hn::Le(first_x, end_x), hn::Le(first_y, end_y));
    seen = hn::Or(seen, beyond);
    seen = hn::And(seen, hn::FirstN(kFloats, static_cast<size_t>(count - i)));
    if (hn::AllFalse(kFloats, seen)) continue;
    V q0 = hn::GatherIndex(kFloats, pq, i0), q1 = hn::GatherIndex(kFloats, pq, i1),
      q2 = hn::GatherIndex(kFloats, pq, i2);
    const V low = hn::Min(q0, hn::Min(q1, q2)), high = hn::Max(q0, hn::Max(q1, q2));
    seen = hn::And(seen, hn::Ge(high, zero));
    const M small = hn::AndNot(beyond, hn::And(hn::Le(hn::Sub(high_x, low_x), Num(kSmall)),
                                               hn::Le(hn::Sub(high_y, low_y), Num(kSmall))));
    V area = hn::Sub(hn::Mul(hn::Sub(x2, x0), hn::Sub(y1, y0)),
                     hn::Mul(hn::Sub(y2, y0), hn::Sub(x1, x0)));
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

    // Blocks. Pixels are below 16 bits, so that their quarters are exact.
    const V quarter = Num(0.25f);
    const V bx0 = hn::Floor(hn::Mul(first_x, quarter)), by0 = hn::Floor(hn::Mul(first_y, quarter));
    const V bx1 = hn::Floor(hn::Mul(end_x, quarter)), by1 = hn::Floor(hn::Mul(end_y, quarter));
    const M tiny = hn::And(
        small, hn::And(hn::Le(hn::Sub(bx1, bx0), Num(1)), hn::Le(hn::Sub(by1, by0), Num(1))));
    const M draw_small = hn::And(seen, tiny), draw_large = hn::AndNot(tiny, seen);

    if (!hn::AllFalse(kFloats, draw_small)) {
      const V ox = hn::Add(hn::Mul(bx0, hn::Mul(Num(4), steps)), half),
              oy = hn::Add(hn::Mul(by0, hn::Mul(Num(4), steps)), half);
      const auto edge = [&](int k, V ax, V ay, V bx, V by) HWY_ATTR {
        const V dx = hn::Sub(ay, by), dy = hn::Sub(bx, ax);
        const M inclusive = hn::Or(hn::Gt(dx, zero), hn::And(hn::Eq(dx, zero), hn::Gt(dy, zero)));
        const V e = hn::Sub(hn::Mul(hn::Sub(ax, ox), hn::Sub(by, oy)),
                            hn::Mul(hn::Sub(ay, oy), hn::Sub(bx, ox)));
        hn::Store(hn::Sub(e, hn::IfThenElse(inclusive, zero, Num(1))), kFloats, b.e[k]);
        hn::Store(hn::Mul(dx, steps), kFloats, b.right[k]);
        hn::Store(hn::Mul(dy, steps), kFloats, b.down[k]);
      };
      edge(0, x2, y2, x1, y1);
      edge(1, x0, y0, x2, y2);
      edge(2, x1, y1, x0, y0);
      const V per_area = hn::Div(Num(1), area);
      hn::Store(q0, kFloats, b.nearness);
      hn::Store(hn::Mul(hn::Sub(q1, q0), per_area), kFloats, b.weight1);
      hn::Store(hn::Mul(hn::Sub(q2, q0), per_area), kFloats, b.weight2);
      hn::Store(low, kFloats, b.low);
      hn::Store(high, kFloats, b.high);
      hn::Store(hn::ConvertTo(kInts, bx0), kInts, b.x0);
      hn::Store(hn::ConvertTo(kInts, bx1), kInts, b.x1);
      hn::Store(hn::ConvertTo(kInts, by0), kInts, b.y0);
      hn::Store(hn::ConvertTo(kInts, by1), kInts, b.y1);
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
    const auto bits = [](M mask) HWY_ATTR {
      uint8_t bytes[8] = {};
      hn::StoreMaskBits(kFloats, mask, bytes);
      return static_cast<uint32_t>(bytes[0] | bytes[1] << 8);
    };
    // In the order of the mesh, whatever their size: of triangles at one place the last is seen.
    const uint32_t of_small = bits(draw_small), of_cut = bits(hn::And(draw_large, beyond));
    for (uint32_t rest = of_small | bits(draw_large); rest != 0; rest &= rest - 1) {
      const int k = __builtin_ctz(rest);
      const uint32_t id = instance.first_id + static_cast<uint32_t>(b.triangle[k]);
      if (of_small >> k & 1) {
        DrawSmall<kIds>(b, k, id, buffer);
      } else if (of_cut >> k & 1) {
        scratch->cut[cut++] = b.triangle[k];
      } else {
        // Turned already: what faces away has the wrong sign.
        Point p[3];
        for (int c = 0; c < 3; ++c) {
          p[c] = {static_cast<int64_t>(b.x[c][k]), static_cast<int64_t>(b.y[c][k])};
        }
        if (!Orient(side == SoftSide::kBoth ? side : SoftSide::kFront, p)) continue;
        ViewPoint v[3];
        for (int c = 0; c < 3; ++c) {
          v[c] = InView(instance, corners[3 * b.triangle[k] + c]);
        }
        PlaneNearness plane;
        if (!PlaneOf(view, v, &plane)) continue;
        DrawLarge<kIds>(view, p, plane, b.low[k], b.high[k], id, buffer);
      }
    }
  }
  for (int k = 0; k < cut; ++k) DrawCut<kIds>(view, instance, scratch->cut[k], buffer);
}

inline void DrawInstanceHere(const SoftView& view, const SoftInstance& instance,
                             SoftScratch* scratch, SoftBuffer* buffer) {
  PlaceVertices(view, instance, scratch);
  const int count = FindFacing(instance, scratch);
  if (buffer->ids.empty()) {
    DrawFacing<false>(view, instance, count, scratch, buffer);
  } else {
    DrawFacing<true>(view, instance, count, scratch, buffer);
  }
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
