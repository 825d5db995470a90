#include "robocell/kinematics/link_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/kinematics/link_kernel.cc"
// The targets of lane_kernel.cc without AVX-512, which is hardly faster for so few links, and slows
// the engine's step beside it by more than its gain.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | (HWY_AVX2 - 1) | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/kinematics/lane_math-inl.h"
#include "robocell/kinematics/lane_quad-inl.h"
#include "robocell/kinematics/link_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Row = LinkTable::Row;
using Links = hn::CappedTag<double, 8>;
using L = hn::Vec<Links>;
constexpr Links kLinks;

HWY_INLINE L At(const Row& row, int first) { return hn::Load(kLinks, row + first); }
HWY_INLINE Vec3<L> At(const Row* rows, int first) {
  return {At(rows[0], first), At(rows[1], first), At(rows[2], first)};
}
HWY_INLINE void Put(L value, int first, Row& row) { hn::Store(value, kLinks, row + first); }
HWY_INLINE void Put(const Vec3<L>& v, int first, Row* rows) {
  Put(v.x, first, rows[0]);
  Put(v.y, first, rows[1]);
  Put(v.z, first, rows[2]);
}
HWY_INLINE Six<L> SixAt(const Row* rows, int first) {
  return {At(rows, first), At(rows + 3, first)};
}
HWY_INLINE void Put(const Six<L>& v, int first, Row* rows) {
  Put(v.linear, first, rows);
  Put(v.angular, first, rows + 3);
}

// One number for each link; 0 for lanes without one.
class Values {
 public:
  HWY_INLINE Values(const double* values, int n) : values_(values), n_(values ? n : 0) {}
  HWY_INLINE L operator[](int first) const {
    if (first >= n_) return hn::Zero(kLinks);
    return hn::MaskedLoad(hn::FirstN(kLinks, n_ - first), kLinks, values_ + first);
  }

 private:
  const double* values_;
  int n_;
};

constexpr int kMost = kMaxChainJoints;

#if HWY_MAX_BYTES >= 32
static_assert(HWY_MAX_BYTES == 32, "sums are over the four lanes of a register");
// 1 for the lanes that get an addition.
struct Lanes {
  alignas(32) double odd[4] = {0, 1, 0, 1};
  alignas(32) double even[4] = {1, 0, 1, 0};
  alignas(32) double upper[4] = {0, 0, 1, 1};
  alignas(32) double lower[4] = {1, 1, 0, 0};
};
constexpr Lanes kLanes;
HWY_INLINE L WithLower(L v) { return hn::ConcatLowerLower(kLinks, v, v); }
HWY_INLINE L WithUpper(L v) { return hn::ConcatUpperUpper(kLinks, v, v); }

// Sums from the base outwards: neighbours, then pairs, then all previous links. It works row after
// row, because code that runs rarely takes longer to load than to run.
template <int kRows>
HWY_INLINE void SumUp(int n, Row* rows) {
  const L odd = hn::Load(kLinks, kLanes.odd), upper = hn::Load(kLinks, kLanes.upper);
#pragma GCC unroll 1
  for (int k = 0; k < kRows; ++k) {
    L before = hn::Zero(kLinks);
#pragma GCC unroll 1
    for (int i = 0; i < n; i += 4) {
      L sum = At(rows[k], i);
      sum = hn::MulAdd(odd, hn::DupEven(sum), sum);
      sum = hn::MulAdd(upper, WithLower(hn::DupOdd(sum)), sum);
      sum = hn::Add(sum, before);
      before = WithUpper(hn::DupOdd(sum));
      Put(sum, i, rows[k]);
    }
  }
}

// Sums from the tip inwards. Lanes without a link hold 0.
template <int kRows>
HWY_INLINE void SumDown(int n, Row* rows) {
  const L even = hn::Load(kLinks, kLanes.even), lower = hn::Load(kLinks, kLanes.lower);
#pragma GCC unroll 1
  for (int k = 0; k < kRows; ++k) {
    L behind = hn::Zero(kLinks);
#pragma GCC unroll 1
    for (int i = (n - 1) / 4 * 4; i >= 0; i -= 4) {
      L sum = At(rows[k], i);
      sum = hn::MulAdd(even, hn::DupOdd(sum), sum);
      sum = hn::MulAdd(lower, WithUpper(hn::DupEven(sum)), sum);
      sum = hn::Add(sum, behind);
      behind = WithLower(hn::DupEven(sum));
      Put(sum, i, rows[k]);
    }
  }
}
#else
template <int kRows>
HWY_INLINE void SumUp(int n, Row* rows) {
  for (int k = 0; k < kRows; ++k) {
    for (int i = 1; i < n; ++i) rows[k][i] += rows[k][i - 1];
  }
}
template <int kRows>
HWY_INLINE void SumDown(int n, Row* rows) {
  for (int k = 0; k < kRows; ++k) {
    for (int i = n - 2; i >= 0; --i) rows[k][i] += rows[k][i + 1];
  }
}
#endif

// x, y, z axis and origin of each link's frame, one row per number.
struct Frames {
  alignas(64) Row rows[12];
};

HWY_INLINE Frame3<L> FrameAt(const Frames& f, int i) {
  return {At(f.rows, i), At(f.rows + 3, i), At(f.rows + 6, i), At(f.rows + 9, i)};
}

// The steps from frame to frame at q: the columns of their rotations, and their translations.
struct Steps {
  alignas(64) Row rotation[6];
  alignas(64) Row translation[3];
};

HWY_INLINE void MakeSteps(const LinkTable& t, const Values& q, Steps* steps) {
  for (int i = 0; i < t.n; i += hn::Lanes(kLinks)) {
    const L off = hn::Sub(q[i], At(t.reference, i));
    L sine, cosine;
    SinCosOfAny(kLinks, hn::Mul(off, At(t.turns, i)), &sine, &cosine);
    const Vec3<L> x = At(t.rotation, i), y = At(t.rotation + 3, i), z = At(t.rotation + 6, i);
    Put(MulAdd(cosine, x, Times(sine, y)), i, steps->rotation);
    Put(MulAdd(cosine, y, Times(hn::Neg(sine), x)), i, steps->rotation + 3);
    Put(MulAdd(hn::Mul(off, At(t.slides, i)), z, At(t.translation, i)), i, steps->translation);
  }
}

// A rotation with the columns x, y, z, and a translation p.
struct Corner {
  Quad x, y, z, p;
};
HWY_INLINE Quad Mix(const Corner& f, double x, double y, double z) {
  return MulAdd(z, f.z, MulAdd(y, f.y, Times(x, f.x)));
}

// The first three of each link's four numbers. Loading a register that is wider than the last
// stores would wait for them, so it is assembled from such halves.
HWY_INLINE Vec3<L> Interleaved(const double (*fours)[4]) {
  Vec3<L> v;
#if HWY_MAX_BYTES >= 64
  const hn::Half<Links> half;
  Vec3<hn::Vec<hn::Half<Links>>> low, high;
  auto unused = hn::Zero(half);
  hn::LoadInterleaved4(half, fours[0], low.x, low.y, low.z, unused);
  hn::LoadInterleaved4(half, fours[4], high.x, high.y, high.z, unused);
  v = {hn::Combine(kLinks, high.x, low.x), hn::Combine(kLinks, high.y, low.y),
       hn::Combine(kLinks, high.z, low.z)};
#else
  L unused;
  hn::LoadInterleaved4(kLinks, fours[0], v.x, v.y, v.z, unused);
#endif
  return v;
}

HWY_INLINE Corner FirstCorner() {
  alignas(64) static constexpr double kUnit[4][4] = {{1}, {0, 1}, {0, 0, 1}, {}};
  return {QuadAt(kUnit[0]), QuadAt(kUnit[1]), QuadAt(kUnit[2]), QuadAt(kUnit[3])};
}

HWY_INLINE Corner Next(const LinkTable& t, const Steps& s, int i, const Corner& f) {
  const Row *r = s.rotation, *m = s.translation;
  return {Mix(f, r[0][i], r[1][i], r[2][i]), Mix(f, r[3][i], r[4][i], r[5][i]),
          Mix(f, t.rotation[6][i], t.rotation[7][i], t.rotation[8][i]),
          MulAdd(m[2][i], f.z, MulAdd(m[1][i], f.y, MulAdd(m[0][i], f.x, f.p)))};
}

HWY_INLINE Corner LastCorner(const LinkTable& t, const Steps& s) {
  Corner f = FirstCorner();
  for (int i = 0; i < t.n; ++i) f = Next(t, s, i, f);
  return f;
}

HWY_INLINE Corner Walk(const LinkTable& t, const Steps& s, Frames* frames) {
  alignas(64) double column[4][kMost][4];
  Corner f = FirstCorner();
  for (int i = 0; i < t.n; ++i) {
    f = Next(t, s, i, f);
    Put(f.x, column[0][i]);
    Put(f.y, column[1][i]);
    Put(f.z, column[2][i]);
    Put(f.p, column[3][i]);
  }
  // The lanes without a link must hold numbers.
  const int width = hn::Lanes(kLinks);
  for (int i = t.n; i % width != 0; ++i) {
    for (auto& of_frames : column) Put(ZeroQuad(), of_frames[i]);
  }
  for (int i = 0; i < t.n; i += width) {
    for (int k = 0; k < 4; ++k) Put(Interleaved(column[k] + i), i, frames->rows + 3 * k);
  }
  return f;
}

// The result is relative to the table's origin.
HWY_INLINE Vec3<L> TipOf(const LinkTable& t, const Corner& last, LinkAnswer* out) {
  const double *r = t.tip_rotation, *m = t.tip_translation;
  Put(Mix(last, r[0], r[1], r[2]), out->tip[0]);
  Put(Mix(last, r[3], r[4], r[5]), out->tip[1]);
  Put(Mix(last, r[6], r[7], r[8]), out->tip[2]);
  Put(MulAdd(m[2], last.z, MulAdd(m[1], last.y, MulAdd(m[0], last.x, last.p))), out->tip[3]);
  double* p = out->tip[3];
  const Vec3<L> tip{hn::Set(kLinks, p[0]), hn::Set(kLinks, p[1]), hn::Set(kLinks, p[2])};
  for (int k = 0; k < 3; ++k) p[k] += t.origin[k];
  return tip;
}

// Computes the torques of the links behind from a force at each link's origin.
HWY_INLINE void GravityOf(const LinkTable& t, const Frames& frames, const double* gravity,
                          Row& torques) {
  alignas(64) Row moment[3];
  for (int i = 0; i < t.n; i += hn::Lanes(kLinks)) {
    const Frame3<L> f = FrameAt(frames, i);
    Put(MulAdd(At(t.weight_mass, i), f.p, Turned(f, At(t.weight_moment, i))), i, moment);
  }
  SumDown<3>(t.n, moment);
  const Vec3<L> g{hn::Set(kLinks, gravity[0]), hn::Set(kLinks, gravity[1]),
                  hn::Set(kLinks, gravity[2])};
  for (int i = 0; i < t.n; i += hn::Lanes(kLinks)) {
    const Frame3<L> f = FrameAt(frames, i);
    const L mass = At(t.weight_behind, i);
    const Vec3<L> arm = MulAdd(hn::Neg(mass), f.p, At(moment, i));
    const Vec3<L> needed =
        MulAdd(hn::Mul(At(t.slides, i), mass), g, Times(At(t.turns, i), Cross(arm, g)));
    Put(hn::Neg(Dot(f.z, needed)), i, torques);
  }
}

// Properties and motion of every link, one row per number.
struct LinkRows {
  alignas(64) Row unit[6];    // the link's, about the origin; later with the links behind it
  alignas(64) Row moment[3];  // the link's, about the origin; later with those behind it
  alignas(64) Row inertia[6];
  alignas(64) Row motion[6];
  alignas(64) Row change[6];
  alignas(64) Row force[6];
};

HWY_INLINE Symmetric3<L> InertiaAt(const Row* rows, int i) {
  return {At(rows[0], i), At(rows[1], i), At(rows[2], i),
          At(rows[3], i), At(rows[4], i), At(rows[5], i)};
}

template <bool kWithMotion>
HWY_INLINE void Describe(const LinkTable& t, const Frames& frames, const Values& qd,
                         LinkRows* rows) {
  for (int i = 0; i < t.n; i += hn::Lanes(kLinks)) {
    const Frame3<L> f = FrameAt(frames, i);
    const Six<L> unit = UnitMotion(At(t.turns, i), At(t.slides, i), f);
    Put(unit, i, rows->unit);
    if (kWithMotion) Put(Times(qd[i], unit), i, rows->motion);
    const RigidBody<L> body =
        InParent(f, RigidBody<L>{At(t.mass, i), At(t.moment, i), InertiaAt(t.inertia, i)});
    Put(body.moment, i, rows->moment);
    const Symmetric3<L>& s = body.inertia;
    Put(Vec3<L>{s.xx, s.yy, s.zz}, i, rows->inertia);
    Put(Vec3<L>{s.xy, s.xz, s.yz}, i, rows->inertia + 3);
  }
}

HWY_INLINE RigidBody<L> BodyAt(const Row& mass, const LinkRows& rows, int i) {
  return {At(mass, i), At(rows.moment, i), InertiaAt(rows.inertia, i)};
}

HWY_INLINE void MotionOf(const LinkTable& t, const Frames& frames, const Values& qd,
                         const Values& qdd, const double* gravity, LinkRows* rows, Row& torques) {
  const int width = hn::Lanes(kLinks);
  SumUp<6>(t.n, rows->motion);
  for (int i = 0; i < t.n; i += width) {
    const Six<L> unit = SixAt(rows->unit, i);
    const Six<L> carried = CarriedMotion(SixAt(rows->motion, i), unit);
    Put(MulAdd(qd[i], carried, Times(qdd[i], unit)), i, rows->change);
  }
  SumUp<6>(t.n, rows->change);
  const Vec3<L> g{hn::Set(kLinks, gravity[0]), hn::Set(kLinks, gravity[1]),
                  hn::Set(kLinks, gravity[2])};
  for (int i = 0; i < t.n; i += width) {
    const RigidBody<L> body = BodyAt(t.mass, *rows, i);
    const Six<L> motion = SixAt(rows->motion, i);
    Six<L> force =
        Add(Momentum(body, SixAt(rows->change, i)), CarriedForce(motion, Momentum(body, motion)));
    const Frame3<L> f = FrameAt(frames, i);
    const L weight = At(t.weight_mass, i);
    const Vec3<L> moment = MulAdd(weight, f.p, Turned(f, At(t.weight_moment, i)));
    force.linear = MulAdd(hn::Neg(weight), g, force.linear);
    force.angular = Sub(force.angular, Cross(moment, g));
    Put(force, i, rows->force);
  }
  SumDown<6>(t.n, rows->force);
  for (int i = 0; i < t.n; i += width) {
    const L torque = Dot(SixAt(rows->unit, i), SixAt(rows->force, i));
    Put(hn::MulAdd(At(t.armature, i), qdd[i], torque), i, torques);
  }
}

// Computes the lower triangle.
HWY_INLINE void MassOf(const LinkTable& t, LinkRows* rows, Row* mass) {
  const int width = hn::Lanes(kLinks);
  SumDown<3>(t.n, rows->moment);
  SumDown<6>(t.n, rows->inertia);
  for (int i = 0; i < t.n; i += width) {
    const RigidBody<L> behind = BodyAt(t.mass_behind, *rows, i);
    Put(Momentum(behind, SixAt(rows->unit, i)), i, rows->force);
  }
  for (int j = 0; j < t.n; ++j) {
    const auto momentum = [&](int k) HWY_ATTR { return hn::Set(kLinks, rows->force[k][j]); };
    const Six<L> of_j{{momentum(0), momentum(1), momentum(2)},
                      {momentum(3), momentum(4), momentum(5)}};
    for (int i = 0; i <= j; i += width) Put(Dot(SixAt(rows->unit, i), of_j), i, mass[j]);
    mass[j][j] += t.armature[j];
  }
}

HWY_INLINE void Mirror(int n, Row* mass) {
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) mass[i][j] = mass[j][i];
  }
}

HWY_INLINE void JacobianOf(const LinkTable& t, const Frames& frames, const Vec3<L>& tip,
                           LinkAnswer* out) {
  for (int i = 0; i < t.n; i += hn::Lanes(kLinks)) {
    const Frame3<L> f = FrameAt(frames, i);
    const Vec3<L> axis = Times(At(t.turns, i), f.z);
    const Vec3<L> linear = MulAdd(At(t.slides, i), f.z, Cross(axis, Sub(tip, f.p)));
    Put(linear, i, out->jacobian);
    Put(axis, i, out->jacobian + 3);
  }
}

HWY_INLINE void ComputeTip(const LinkTable& t, const LinkQuery& query, LinkAnswer* out) {
  Steps steps;
  MakeSteps(t, Values(query.q, t.n), &steps);
  TipOf(t, LastCorner(t, steps), out);
}

template <bool kTip, bool kJacobian, bool kMass, bool kGravity, bool kMotion>
HWY_INLINE void ComputeParts(const LinkTable& t, const LinkQuery& query, LinkAnswer* out) {
  const Values q(query.q, t.n), qd(query.qd, t.n), qdd(query.qdd, t.n);
  Steps steps;
  MakeSteps(t, q, &steps);
  Frames frames;
  const Corner last = Walk(t, steps, &frames);
  if (kTip) {
    const Vec3<L> tip = TipOf(t, last, out);
    if (kJacobian) JacobianOf(t, frames, tip, out);
  }
  if (kGravity) GravityOf(t, frames, query.gravity, out->torques);
  LinkRows rows;
  if (kMass || kMotion) Describe<kMotion>(t, frames, qd, &rows);
  if (kMotion) MotionOf(t, frames, qd, qdd, query.gravity, &rows, out->torques);
  if (kMass) MassOf(t, &rows, out->mass);
  if (kMass && !kMotion) Mirror(t.n, out->mass);
}

void Compute(const LinkTable& t, LinkPart part, const LinkQuery& query, LinkAnswer* out) {
  switch (part) {
    case LinkPart::kTip:
      return ComputeTip(t, query, out);
    case LinkPart::kJacobian:
      return ComputeParts<true, true, false, false, false>(t, query, out);
    case LinkPart::kMass:
      return ComputeParts<false, false, true, false, false>(t, query, out);
    case LinkPart::kGravity:
      return ComputeParts<false, false, false, true, false>(t, query, out);
    case LinkPart::kMotion:
      return ComputeParts<false, false, false, false, true>(t, query, out);
    case LinkPart::kAll:
      return ComputeParts<true, true, true, false, true>(t, query, out);
  }
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell::internal {

HWY_EXPORT(Compute);

void ComputeLinks(const LinkTable& table, LinkPart part, const LinkQuery& query, LinkAnswer* out) {
  HWY_DYNAMIC_DISPATCH(Compute)(table, part, query, out);
}

}  // namespace robocell::internal
#endif
