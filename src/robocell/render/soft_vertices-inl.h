// Finds the visible triangles of an instance and the image positions of their vertices; part of
// soft_kernel.cc, compiled for each instruction set.
#if defined(ROBOCELL_SOFT_VERTICES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_VERTICES_INL_H_
#undef ROBOCELL_SOFT_VERTICES_INL_H_
#else
#define ROBOCELL_SOFT_VERTICES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "robocell/render/soft_blocks-inl.h"
#include "robocell/render/soft_frame.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
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

// Largest scale from mesh to view. A little more than 1 if
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

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
