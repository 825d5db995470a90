// Large triangles into blocks of pixels, one at a time, cut where the camera's near plane or the
// reach of exact edge functions ends; part of soft_kernel.cc, compiled for each instruction set.
#if defined(ROBOCELL_SOFT_LARGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_LARGE_INL_H_
#undef ROBOCELL_SOFT_LARGE_INL_H_
#else
#define ROBOCELL_SOFT_LARGE_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "robocell/render/soft_blocks-inl.h"
#include "robocell/render/soft_frame.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
// Nearness on a plane: at the first pixel of the image, and its steps.
struct PlaneNearness {
  double first = 0, right = 0, down = 0;
};

// Returns the nearness of the plane n . p = c in view axes.
inline PlaneNearness NearnessOf(const SoftView& view, const double n[3], double c) {
  const double x = n[0] / view.fx, y = -n[1] / view.fy;
  double at = -(x * view.cx + y * view.cy);  // n.x x + n.y y at pixel (0, 0), depth 1
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
  double e[3];                 // values at the row's first block
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

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
