#include "robocell/motion/sphere_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/motion/sphere_kernel.cc"
// The targets of render/soft_kernel.cc.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Wider registers check no faster: more lanes go down to fine spheres for the sake of one.
using Floats = hn::CappedTag<float, kLanes>;
constexpr Floats kFloats;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;
constexpr int kWidth = HWY_MAX(static_cast<int>(hn::MaxLanes(kFloats)), 1);

// Products and sums are rounded one by one, so that every instruction set has the same numbers.
HWY_INLINE V Every(float value) { return hn::Set(kFloats, value); }
HWY_INLINE V Sum(V a, V b) { return hn::Add(a, b); }
HWY_INLINE V Sum(V a, V b, V c) { return hn::Add(hn::Add(a, b), c); }

struct V3 {
  V x, y, z;
};
HWY_INLINE V Dot(const float* a, const V3& b) {
  return Sum(hn::Mul(Every(a[0]), b.x), hn::Mul(Every(a[1]), b.y), hn::Mul(Every(a[2]), b.z));
}
HWY_INLINE V Squared(const V3& a) {
  return Sum(hn::Mul(a.x, a.x), hn::Mul(a.y, a.y), hn::Mul(a.z, a.z));
}
HWY_INLINE V3 Minus(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE bool Some(M mask) { return !hn::AllFalse(kFloats, mask); }
HWY_INLINE uint32_t BitsOf(M mask) {
  alignas(64) uint8_t bytes[8] = {};
  hn::StoreMaskBits(kFloats, mask, bytes);
  return bytes[0];
}

// Sine and cosine of |x| <= pi (and somewhat more), within 2e-7: by quarter turns and the
// polynomials of Cephes (S. Moshier, sinf).
HWY_INLINE void SineAndCosine(V x, V* sine, V* cosine) {
  const V turns = hn::Round(hn::Mul(x, Every(0.636619772f)));
  V r = hn::Sub(x, hn::Mul(turns, Every(1.5703125f)));
  r = hn::Sub(r, hn::Mul(turns, Every(4.837512969970703125e-4f)));
  r = hn::Sub(r, hn::Mul(turns, Every(7.54978995489188216e-8f)));
  const V r2 = hn::Mul(r, r);
  V s = Sum(hn::Mul(Every(-1.9515295891e-4f), r2), Every(8.3321608736e-3f));
  s = Sum(hn::Mul(s, r2), Every(-1.6666654611e-1f));
  s = Sum(hn::Mul(hn::Mul(s, r2), r), r);
  V c = Sum(hn::Mul(Every(2.443315711809948e-5f), r2), Every(-1.388731625493765e-3f));
  c = Sum(hn::Mul(c, r2), Every(4.166664568298827e-2f));
  c = Sum(hn::Mul(hn::Mul(c, r2), r2), hn::Sub(Every(1.0f), hn::Mul(Every(0.5f), r2)));
  const hn::RebindToSigned<Floats> ints;
  const auto quarter = hn::NearestInt(turns);
  const auto one = hn::Set(ints, 1), two = hn::Set(ints, 2);
  const M odd = hn::RebindMask(kFloats, hn::TestBit(quarter, one));
  const M sine_below = hn::RebindMask(kFloats, hn::TestBit(quarter, two));
  const M cosine_below = hn::RebindMask(kFloats, hn::TestBit(hn::Add(quarter, one), two));
  const V a = hn::IfThenElse(odd, c, s), b = hn::IfThenElse(odd, s, c);
  *sine = hn::IfThenElse(sine_below, hn::Neg(a), a);
  *cosine = hn::IfThenElse(cosine_below, hn::Neg(b), b);
}

// The lanes of one register: `first` is the first of them among the kLanes configurations.
class Lanes {
 public:
  Lanes(const SphereTable& table, const DemandOfSpheres& demand, SphereScratch* scratch, int first)
      : t_(table), demand_(demand), s_(*scratch), first_(first) {
    if (++s_.group == 0) {  // once in four billion
      std::fill(s_.known.begin(), s_.known.end(), 0);
      s_.group = 1;
    }
    for (int k = 0; k < 12; ++k) Put(s_.frames[k], Every(k % 4 == 0 && k < 9 ? 1.0f : 0.0f));
  }

  // Returns the lanes that hit something. With `any`, at the first one. `pairs` may be null; with it
  // nothing is left out.
  uint32_t Find(const double* q, int count, bool any, std::vector<SpherePair>* pairs) {
    pairs_ = pairs;
    any_ = any && !pairs;
    hits_ = 0;
    const auto links = static_cast<int32_t>(t_.links.size());
    for (int32_t l = 1; l < links; ++l) {
      Place(l, q, count);
      const SphereTable::Link& link = t_.links[l];
      if (link.ball.radius < 0) continue;
      const V3 centre = InWorld(l, link.ball);
      Put(s_.balls[3 * l], centre.x);
      Put(s_.balls[3 * l + 1], centre.y);
      Put(s_.balls[3 * l + 2], centre.z);
      if (MeetObstacles(link, centre) || MeetLinks(link, centre)) break;
    }
    return hits_;
  }

 private:
  HWY_INLINE void Put(SphereScratch::Lanes& to, V value) {
    hn::StoreU(value, kFloats, to.at + first_);
  }
  HWY_INLINE V Get(const SphereScratch::Lanes& from) const {
    return hn::LoadU(kFloats, from.at + first_);
  }

  void Place(int32_t l, const double* q, int count) {
    const SphereTable::Link& link = t_.links[l];
    alignas(64) float by[kWidth];
    for (int k = 0; k < kWidth; ++k) {
      // Lanes without a configuration repeat the last one.
      const double* row = q + static_cast<size_t>(std::min(first_ + k, count - 1)) * t_.dofs;
      double x = row[link.dof];
      if (link.follows) {
        const double d = x - link.from;
        const double* c = link.polynomial;
        x = c[0] + d * (c[1] + d * (c[2] + d * (c[3] + d * c[4])));
      }
      x -= link.reference;
      if (!link.slide && std::abs(x) > std::numbers::pi)
        x -= 2 * std::numbers::pi * std::nearbyint(x / (2 * std::numbers::pi));
      by[k] = static_cast<float>(x);
    }
    const V moved = hn::Load(kFloats, by);
    const SphereScratch::Lanes* parent = &s_.frames[12 * static_cast<size_t>(link.parent)];
    SphereScratch::Lanes* frame = &s_.frames[12 * static_cast<size_t>(l)];
    V sine = Every(0), cosine = Every(1);
    if (!link.slide) SineAndCosine(moved, &sine, &cosine);
    for (int row = 0; row < 3; ++row) {
      const V3 r{Get(parent[3 * row]), Get(parent[3 * row + 1]), Get(parent[3 * row + 2])};
      const float* f = link.rotation;
      const float x[3] = {f[0], f[3], f[6]}, y[3] = {f[1], f[4], f[7]}, z[3] = {f[2], f[5], f[8]};
      const V rx = Dot(x, r), ry = Dot(y, r), rz = Dot(z, r);
      V at = Sum(Dot(link.translation, r), Get(parent[9 + row]));
      if (link.slide) at = Sum(at, hn::Mul(rz, moved));
      Put(frame[3 * row], Sum(hn::Mul(rx, cosine), hn::Mul(ry, sine)));
      Put(frame[3 * row + 1], hn::Sub(hn::Mul(ry, cosine), hn::Mul(rx, sine)));
      Put(frame[3 * row + 2], rz);
      Put(frame[9 + row], at);
    }
  }

  HWY_INLINE V3 InWorld(int32_t link, const SphereTable::Ball& ball) const {
    const SphereScratch::Lanes* f = &s_.frames[12 * static_cast<size_t>(link)];
    const V x = Every(ball.x), y = Every(ball.y), z = Every(ball.z);
    const auto row = [&](int r) HWY_ATTR {
      return Sum(Sum(hn::Mul(Get(f[3 * r]), x), hn::Mul(Get(f[3 * r + 1]), y)),
                 Sum(hn::Mul(Get(f[3 * r + 2]), z), Get(f[9 + r])));
    };
    return {row(0), row(1), row(2)};
  }

  V3 CentreOf(int32_t node, int32_t link) {
    SphereScratch::Lanes* c = &s_.centres[3 * static_cast<size_t>(node)];
    if (s_.known[node] == s_.group) return {Get(c[0]), Get(c[1]), Get(c[2])};
    s_.known[node] = s_.group;
    const V3 centre = InWorld(link, t_.nodes[node].ball);
    Put(c[0], centre.x);
    Put(c[1], centre.y);
    Put(c[2], centre.z);
    return centre;
  }

  // Returns true where a ball touches an obstacle; never false for one that does.
  M Touches(const SphereTable::Obstacle& o, const V3& p, float radius) const {
    const V r = Every(radius), zero = hn::Zero(kFloats);
    const V3 d = Minus(p, {Every(o.centre[0]), Every(o.centre[1]), Every(o.centre[2])});
    switch (o.shape) {
      case SphereTable::Shape::kBall: {
        const float reach = radius + o.size[0];
        return hn::Le(Squared(d), Every(reach * reach));
      }
      case SphereTable::Shape::kBox: {
        const V3 out{hn::Max(hn::Sub(hn::Abs(Dot(o.axes, d)), Every(o.size[0])), zero),
                     hn::Max(hn::Sub(hn::Abs(Dot(o.axes + 3, d)), Every(o.size[1])), zero),
                     hn::Max(hn::Sub(hn::Abs(Dot(o.axes + 6, d)), Every(o.size[2])), zero)};
        return hn::Le(Squared(out), hn::Mul(r, r));
      }
      case SphereTable::Shape::kCapsule: {
        const float* axis = o.axes + 6;
        const V along = hn::Max(hn::Min(Dot(axis, d), Every(o.size[1])), Every(-o.size[1]));
        const V3 out = Minus(d, {hn::Mul(along, Every(axis[0])), hn::Mul(along, Every(axis[1])),
                                 hn::Mul(along, Every(axis[2]))});
        const float reach = radius + o.size[0];
        return hn::Le(Squared(out), Every(reach * reach));
      }
      case SphereTable::Shape::kCylinder: {
        const V along = Dot(o.axes + 6, d);
        const V across = hn::Sqrt(hn::Max(hn::Sub(Squared(d), hn::Mul(along, along)), zero));
        const V beside = hn::Max(hn::Sub(across, Every(o.size[0])), zero);
        const V above = hn::Max(hn::Sub(hn::Abs(along), Every(o.size[1])), zero);
        return hn::Le(Sum(hn::Mul(beside, beside), hn::Mul(above, above)), hn::Mul(r, r));
      }
      case SphereTable::Shape::kPolytope: {
        const float reach = radius + o.ball.radius;
        const V3 to_ball = Minus(p, {Every(o.ball.x), Every(o.ball.y), Every(o.ball.z)});
        M touches = hn::Le(Squared(to_ball), Every(reach * reach));
        for (int32_t k = o.planes.first; k < o.planes.last && Some(touches); ++k)
          touches = hn::And(touches, Within(t_.planes[k], p, radius));
        return touches;
      }
      case SphereTable::Shape::kHalfSpace:
        return Within(t_.planes[o.planes.first], p, radius);
    }
    return hn::Lt(r, r);
  }
  HWY_INLINE M Within(const SphereTable::Plane& plane, const V3& p, float radius) const {
    return hn::Le(Dot(plane.normal, p), Every(plane.offset + radius));
  }

  HWY_INLINE float MarginTo(const SphereTable::Tree& tree, bool own) const {
    return own ? demand_.own_clearance - demand_.shrunk * tree.shrink : demand_.clearance;
  }

  // These return true if the search is over.
  bool MeetObstacles(const SphereTable::Link& link, const V3& centre) {
    const float margin = std::max(demand_.clearance, demand_.own_clearance);
    size_t count = 0;
    for (int32_t k = link.near.first; k < link.near.last; ++k) {
      const int32_t o = t_.near[k];
      if (Some(Touches(t_.obstacles[o], centre, link.ball.radius + margin))) s_.active[count++] = o;
    }
    for (size_t k = 0; k < count; ++k) {
      for (int32_t tree = link.trees.first; tree < link.trees.last; ++tree) {
        if (MeetObstacle(tree, s_.active[k])) return true;
      }
    }
    return false;
  }

  bool MeetObstacle(int32_t tree_index, int32_t o) {
    if (t_.ignored[static_cast<size_t>(tree_index) * t_.obstacles.size() + o]) return false;
    const SphereTable::Tree& tree = t_.trees[tree_index];
    const SphereTable::Obstacle& obstacle = t_.obstacles[o];
    const bool own = tree.own && obstacle.own;
    const float margin = MarginTo(tree, own);
    uint32_t found = 0;
    for (int32_t n = tree.nodes.first; n < tree.nodes.last;) {
      const SphereTable::Node& node = t_.nodes[n];
      const M touches = Touches(obstacle, CentreOf(n, tree.link), node.ball.radius + margin);
      if (!Some(touches)) {
        n = node.next;
        continue;
      }
      if (node.next == n + 1) {
        found |= BitsOf(touches) << first_;
        if (any_) break;
      }
      ++n;
    }
    return Report(found, tree.geom, obstacle.geom, own);
  }

  bool MeetLinks(const SphereTable::Link& link, const V3& centre) {
    for (int32_t k = link.pairs.first; k < link.pairs.last; ++k) {
      const SphereTable::LinkPair& pair = t_.link_pairs[k];
      const float margin = std::max(demand_.clearance, demand_.own_clearance);
      const float reach = link.ball.radius + t_.links[pair.other].ball.radius + margin;
      const SphereScratch::Lanes* other = &s_.balls[3 * static_cast<size_t>(pair.other)];
      const V3 between = Minus(centre, {Get(other[0]), Get(other[1]), Get(other[2])});
      if (!Some(hn::Le(Squared(between), Every(reach * reach)))) continue;
      for (int32_t p = pair.trees.first; p < pair.trees.last; ++p) {
        if (MeetTree(t_.tree_pairs[p])) return true;
      }
    }
    return false;
  }

  bool MeetTree(const SphereTable::TreePair& pair) {
    const SphereTable::Tree &a = t_.trees[pair.tree], &b = t_.trees[pair.other];
    const float margin = MarginTo(a, pair.own) - (pair.own ? demand_.shrunk * b.shrink : 0.0f);
    const float other_ball = t_.nodes[b.nodes.first].ball.radius;
    const V3 other_centre = CentreOf(b.nodes.first, b.link);
    uint32_t found = 0;
    for (int32_t n = a.nodes.first; n < a.nodes.last && !(any_ && found);) {
      const SphereTable::Node& node = t_.nodes[n];
      const V3 centre = CentreOf(n, a.link);
      if (!Some(Near(centre, other_centre, node.ball.radius + other_ball + margin))) {
        n = node.next;
        continue;
      }
      if (node.next == n + 1) found |= MeetLeaf(centre, node.ball.radius + margin, b);
      ++n;
    }
    return Report(found, a.geom, b.geom, pair.own);
  }
  uint32_t MeetLeaf(const V3& centre, float radius, const SphereTable::Tree& tree) {
    uint32_t found = 0;
    for (int32_t n = tree.nodes.first; n < tree.nodes.last;) {
      const SphereTable::Node& node = t_.nodes[n];
      const M near = Near(centre, CentreOf(n, tree.link), radius + node.ball.radius);
      if (!Some(near)) {
        n = node.next;
        continue;
      }
      if (node.next == n + 1) {
        found |= BitsOf(near) << first_;
        if (any_) return found;
      }
      ++n;
    }
    return found;
  }
  HWY_INLINE M Near(const V3& a, const V3& b, float reach) const {
    return hn::Le(Squared(Minus(a, b)), Every(reach * std::max(reach, 0.0f)));
  }

  bool Report(uint32_t found, int32_t geom, int32_t other, bool own) {
    if (found == 0) return false;
    hits_ |= found;
    if (pairs_) pairs_->push_back({geom, other, found, own});
    return any_;
  }

  const SphereTable& t_;
  const DemandOfSpheres& demand_;
  SphereScratch& s_;
  const int first_;
  std::vector<SpherePair>* pairs_ = nullptr;
  bool any_ = false;
  uint32_t hits_ = 0;
};

uint32_t Find(const SphereTable& table, const DemandOfSpheres& demand, const double* q, int count,
              bool any, SphereScratch* scratch, std::vector<SpherePair>* pairs) {
  uint32_t hits = 0;
  for (int first = 0; first < count && !(any && hits); first += kWidth)
    hits |= Lanes(table, demand, scratch, first).Find(q, count, any, pairs);
  return hits & ((1u << count) - 1);
}

int Nearest(const float* points, int stride, int count, int dofs, const float* q) {
  // Each lane keeps its nearest; the first of equals has the lowest index in each.
  alignas(64) float least[kWidth];
  alignas(64) int32_t index[kWidth];
  const hn::RebindToSigned<Floats> ints;
  V best = Every(std::numeric_limits<float>::infinity());
  auto where = hn::Zero(ints), here = hn::Iota(ints, 0);
  for (int i = 0; i < count; i += kWidth) {
    V sum = hn::Zero(kFloats);
    for (int k = 0; k < dofs; ++k) {
      const V d =
          hn::Sub(hn::LoadU(kFloats, points + static_cast<size_t>(k) * stride + i), Every(q[k]));
      sum = Sum(sum, hn::Mul(d, d));
    }
    const auto exists = hn::Lt(here, hn::Set(ints, count));
    const M nearer = hn::And(hn::Lt(sum, best), hn::RebindMask(kFloats, exists));
    best = hn::IfThenElse(nearer, sum, best);
    where = hn::IfThenElse(hn::RebindMask(ints, nearer), here, where);
    here = hn::Add(here, hn::Set(ints, kWidth));
  }
  hn::Store(best, kFloats, least);
  hn::Store(where, ints, index);
  int nearest = 0;
  for (int k = 1; k < kWidth; ++k) {
    if (least[k] < least[nearest] || (least[k] == least[nearest] && index[k] < index[nearest]))
      nearest = k;
  }
  return index[nearest];
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell::internal {

HWY_EXPORT(Find);
HWY_EXPORT(Nearest);

void SphereScratch::Fit(const SphereTable& table) {
  frames.resize(12 * table.links.size());
  balls.resize(3 * table.links.size());
  centres.resize(3 * table.nodes.size());
  known.assign(table.nodes.size(), 0);
  active.resize(table.obstacles.size());
  group = 0;
}

uint32_t FindSphereHits(const SphereTable& table, const DemandOfSpheres& demand,
                        std::span<const double> q, int count, bool any, SphereScratch* scratch) {
  if (count == 0) return 0;
  return HWY_DYNAMIC_DISPATCH(Find)(table, demand, q.data(), count, any, scratch, nullptr);
}

void FindSpherePairs(const SphereTable& table, const DemandOfSpheres& demand,
                     std::span<const double> q, int count, SphereScratch* scratch,
                     std::vector<SpherePair>* pairs) {
  pairs->clear();
  if (count == 0) return;
  HWY_DYNAMIC_DISPATCH(Find)(table, demand, q.data(), count, false, scratch, pairs);
  for (SpherePair& pair : *pairs) pair.lanes &= (1u << count) - 1;
}

int FindNearest(const float* points, int stride, int count, int dofs, const float* q) {
  return HWY_DYNAMIC_DISPATCH(Nearest)(points, stride, count, dofs, q);
}

}  // namespace robocell::internal
#endif
