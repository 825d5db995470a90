#include "robocell/kinematics/pose_kernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/kinematics/pose_kernel.cc"
// As in lane_kernel.cc.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/kinematics/lane_math-inl.h"
#include "robocell/kinematics/lane_quad-inl.h"
#include "robocell/kinematics/link_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kMostPoses = 8;
// Of the largest on a diagonal.
constexpr double kLeastPivot = 1e-20;
using Configurations = hn::CappedTag<double, kMostPoses>;
using P = hn::Vec<Configurations>;
constexpr Configurations kPoses;

HWY_INLINE P All(double value) { return hn::Set(kPoses, value); }
HWY_INLINE Vec3<P> All(const LinkTable::Row* rows, int i) {
  return {All(rows[0][i]), All(rows[1][i]), All(rows[2][i])};
}

// The numbers of some configurations side by side. Lanes behind the last one do what it does.
class Inputs {
 public:
  HWY_INLINE Inputs(const PoseRows& rows, std::size_t first, std::size_t last, int numbers) {
    for (int lane = 0; lane < static_cast<int>(hn::Lanes(kPoses)); ++lane) {
      const double* from = rows.data + std::min(first + lane, last) * rows.stride;
      for (int k = 0; k < numbers; ++k) values_[k][lane] = from[k];
    }
  }
  HWY_INLINE P operator[](int k) const { return hn::Load(kPoses, values_[k]); }

 private:
  alignas(64) double values_[kMaxChainJoints][kMostPoses];
};

// Results of some configurations, to be written one after the other.
template <int kMost>
class Outputs {
 public:
  HWY_INLINE void Put(int k, P value) { hn::Store(value, kPoses, values_[k]); }
  HWY_INLINE void Write(int lanes, int numbers, double* out) const {
    const int fours = HWY_MIN(numbers, kMost) / 4 * 4;
    for (int k = 0; k < fours; k += 4) {
      alignas(64) double turned[kMostPoses][4];
      hn::StoreInterleaved4(At(k), At(k + 1), At(k + 2), At(k + 3), kPoses, turned[0]);
      for (int lane = 0; lane < lanes; ++lane)
        PutAnywhere(QuadAt(turned[lane]), out + lane * numbers + k);
    }
    for (int k = fours; k < HWY_MIN(numbers, kMost); ++k) {
      for (int lane = 0; lane < lanes; ++lane) out[lane * numbers + k] = values_[k][lane];
    }
  }

 private:
  HWY_INLINE P At(int k) const { return hn::Load(kPoses, values_[k]); }

  alignas(64) double values_[kMost][kMostPoses];
};

HWY_INLINE Frame3<P> FirstFrame() {
  const P zero = hn::Zero(kPoses), one = All(1);
  return {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}, {zero, zero, zero}};
}

// To the frame of joint i, from that before.
HWY_INLINE void StepTo(const LinkTable& t, int i, P q, Frame3<P>* f) {
  const Vec3<P> x = All(t.rotation, i), y = All(t.rotation + 3, i), z = All(t.rotation + 6, i);
  Frame3<P> next;
  if (i == 0) {
    next = {x, y, z, f->p};
  } else {
    next = {Turned(*f, x), Turned(*f, y), Turned(*f, z),
            Add(f->p, Turned(*f, All(t.translation, i)))};
  }
  const P off = hn::Sub(q, All(t.reference[i]));
  if (t.slides[i] != 0) {
    next.p = MulAdd(off, next.z, next.p);
    *f = next;
    return;
  }
  P sine, cosine;
  SinCosOfAny(kPoses, off, &sine, &cosine);
  f->x = MulAdd(cosine, next.x, Times(sine, next.y));
  f->y = MulAdd(cosine, next.y, Times(hn::Neg(sine), next.x));
  f->z = next.z;
  f->p = next.p;
}

// Calls visit(i, frame) for each joint, the frames counted from the table's origin; the last one.
template <class Visit>
HWY_INLINE Frame3<P> WalkPoses(const LinkTable& t, const Inputs& q, Visit&& visit) {
  Frame3<P> f = FirstFrame();
  for (int i = 0; i < t.n; ++i) {
    StepTo(t, i, q[i], &f);
    visit(i, f);
  }
  return f;
}

HWY_INLINE Vec3<P> All(const double* v) { return {All(v[0]), All(v[1]), All(v[2])}; }

HWY_INLINE Vec3<P> TipPosition(const LinkTable& t, const Frame3<P>& last) {
  return Add(last.p, Turned(last, All(t.tip_translation)));
}

HWY_INLINE void TipsOf(const LinkTable& t, const Inputs& q, int lanes, double* out) {
  Outputs<16> tips;
  const Frame3<P> last = WalkPoses(t, q, [](int, const Frame3<P>&) HWY_ATTR {});
  const Vec3<P> columns[4] = {
      Turned(last, All(t.tip_rotation)), Turned(last, All(t.tip_rotation + 3)),
      Turned(last, All(t.tip_rotation + 6)), Add(TipPosition(t, last), All(t.origin))};
  for (int c = 0; c < 4; ++c) {
    tips.Put(c, columns[c].x);
    tips.Put(4 + c, columns[c].y);
    tips.Put(8 + c, columns[c].z);
    tips.Put(12 + c, All(c == 3));
  }
  tips.Write(lanes, 16, out);
}

// Of the Jacobian at the tip.
struct Column {
  P row[6];  // linear ones first
};

HWY_INLINE void ColumnsOf(const LinkTable& t, const Inputs& q, Column* columns) {
  Vec3<P> axis[kMaxChainJoints], point[kMaxChainJoints];
  const Frame3<P> last = WalkPoses(t, q, [&](int i, const Frame3<P>& f) HWY_ATTR {
    axis[i] = f.z;
    point[i] = f.p;
  });
  const Vec3<P> tip = TipPosition(t, last);
  const P zero = hn::Zero(kPoses);
  for (int i = 0; i < t.n; ++i) {
    const bool slide = t.slides[i] != 0;
    const Vec3<P> linear = slide ? axis[i] : Cross(axis[i], Sub(tip, point[i]));
    const Vec3<P> angular = slide ? Vec3<P>{zero, zero, zero} : axis[i];
    columns[i] = {{linear.x, linear.y, linear.z, angular.x, angular.y, angular.z}};
  }
}

HWY_INLINE void JacobiansOf(const LinkTable& t, const Inputs& q, int lanes, double* out) {
  Column columns[kMaxChainJoints];
  ColumnsOf(t, q, columns);
  Outputs<6 * kMaxChainJoints> jacobian;
  for (int i = 0; i < t.n; ++i) {
    for (int r = 0; r < 6; ++r) jacobian.Put(r * t.n + i, columns[i].row[r]);
  }
  jacobian.Write(lanes, 6 * t.n, out);
}

// The lower triangle of the smaller of J J^T and J^T J; how many rows it has.
HWY_INLINE int SquaredOf(const Column* columns, int n, P (*square)[6]) {
  const int rows = HWY_MIN(n, 6);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c <= r; ++c) {
      P sum = hn::Zero(kPoses);
      for (int k = 0, end = HWY_MAX(n, 6); k < end; ++k) {
        sum = n < 6 ? hn::MulAdd(columns[r].row[k], columns[c].row[k], sum)
                    : hn::MulAdd(columns[k].row[r], columns[k].row[c], sum);
      }
      square[r][c] = sum;
    }
  }
  return rows;
}

// The root of the determinant of a symmetric matrix without negative eigenvalues. Uses it up.
HWY_INLINE P RootOfDeterminant(P (*a)[6], int rows) {
  P largest = hn::Zero(kPoses), product = All(1);
  for (int k = 0; k < rows; ++k) largest = hn::Max(largest, a[k][k]);
  // What is divided by; where a pivot is below it the product is next to nothing, whatever follows.
  const P least = hn::Max(hn::Mul(All(kLeastPivot), largest), All(kLeastPivot));
  for (int k = 0; k < rows; ++k) {
    product = hn::Mul(product, hn::Max(a[k][k], hn::Zero(kPoses)));
    const P inverse = hn::Div(All(1), hn::Max(a[k][k], least));
    for (int r = k + 1; r < rows; ++r) {
      const P factor = hn::Mul(a[r][k], inverse);
      for (int c = k + 1; c <= r; ++c) a[r][c] = hn::NegMulAdd(factor, a[c][k], a[r][c]);
    }
  }
  return hn::Sqrt(product);
}

HWY_INLINE void ManipulabilitiesOf(const LinkTable& t, const Inputs& q, int lanes, double* out) {
  Column columns[kMaxChainJoints];
  ColumnsOf(t, q, columns);
  P square[6][6];
  const int rows = SquaredOf(columns, t.n, square);
  Outputs<1> values;
  values.Put(0, RootOfDeterminant(square, rows));
  values.Write(lanes, 1, out);
}

HWY_INLINE Vec3<P> Three(const Inputs& in) { return {in[0], in[1], in[2]}; }

HWY_INLINE void GravitiesOf(const LinkTable& t, const Inputs& q, const Inputs& gravity, int lanes,
                            double* out) {
  Vec3<P> axis[kMaxChainJoints], point[kMaxChainJoints], moment[kMaxChainJoints];
  WalkPoses(t, q, [&](int i, const Frame3<P>& f) HWY_ATTR {
    axis[i] = f.z;
    point[i] = f.p;
    moment[i] = MulAdd(All(t.weight_mass[i]), f.p, Turned(f, All(t.weight_moment, i)));
  });
  const Vec3<P> g = Three(gravity);
  Vec3<P> sum{hn::Zero(kPoses), hn::Zero(kPoses), hn::Zero(kPoses)};
  Outputs<kMaxChainJoints> torques;
  for (int i = t.n - 1; i >= 0; --i) {
    const P mass = All(t.weight_behind[i]);
    sum = Add(sum, moment[i]);
    const Vec3<P> needed =
        t.slides[i] != 0 ? Times(mass, g) : Cross(MulAdd(hn::Neg(mass), point[i], sum), g);
    torques.Put(i, hn::Neg(Dot(axis[i], needed)));
  }
  torques.Write(lanes, t.n, out);
}

HWY_INLINE RigidBody<P> BodyOf(const LinkTable& t, int i, const Frame3<P>& f) {
  const auto at = [&](int k) HWY_ATTR { return All(t.inertia[k][i]); };
  return InParent(
      f,
      RigidBody<P>{All(t.mass[i]), All(t.moment, i), {at(0), at(1), at(2), at(3), at(4), at(5)}});
}

HWY_INLINE Six<P> UnitOf(const LinkTable& t, int i, const Frame3<P>& f) {
  const P zero = hn::Zero(kPoses);
  if (t.slides[i] != 0) return {f.z, {zero, zero, zero}};
  return {Cross(f.p, f.z), f.z};
}

HWY_INLINE void Include(const RigidBody<P>& more, RigidBody<P>* sum) {
  Symmetric3<P>& s = sum->inertia;
  const Symmetric3<P>& m = more.inertia;
  sum->moment = Add(sum->moment, more.moment);
  s = {hn::Add(s.xx, m.xx), hn::Add(s.yy, m.yy), hn::Add(s.zz, m.zz),
       hn::Add(s.xy, m.xy), hn::Add(s.xz, m.xz), hn::Add(s.yz, m.yz)};
}

HWY_INLINE void MassesOf(const LinkTable& t, const Inputs& q, int lanes, double* out) {
  Six<P> unit[kMaxChainJoints];
  RigidBody<P> bodies[kMaxChainJoints];
  WalkPoses(t, q, [&](int i, const Frame3<P>& f) HWY_ATTR {
    unit[i] = UnitOf(t, i, f);
    bodies[i] = BodyOf(t, i, f);
  });
  Outputs<kMaxChainJoints * kMaxChainJoints> mass;
  RigidBody<P> behind = bodies[t.n - 1];
  for (int j = t.n - 1; j >= 0; --j) {
    if (j < t.n - 1) Include(bodies[j], &behind);
    behind.mass = All(t.mass_behind[j]);
    const Six<P> momentum = Momentum(behind, unit[j]);
    for (int i = 0; i <= j; ++i) {
      P entry = Dot(unit[i], momentum);
      if (i == j) entry = hn::Add(entry, All(t.armature[j]));
      mass.Put(i * t.n + j, entry);
      mass.Put(j * t.n + i, entry);
    }
  }
  mass.Write(lanes, t.n * t.n, out);
}

HWY_INLINE void MotionsOf(const LinkTable& t, const Inputs& q, const Inputs& qd, const Inputs& qdd,
                          const Inputs& gravity, int lanes, double* out) {
  Six<P> unit[kMaxChainJoints], force[kMaxChainJoints];
  const P zero = hn::Zero(kPoses);
  const Six<P> none{{zero, zero, zero}, {zero, zero, zero}};
  Six<P> motion = none, change = none;
  const Vec3<P> g = Three(gravity);
  WalkPoses(t, q, [&](int i, const Frame3<P>& f) HWY_ATTR {
    unit[i] = UnitOf(t, i, f);
    const RigidBody<P> body = BodyOf(t, i, f);
    motion = MulAdd(qd[i], unit[i], motion);
    change = Add(change, MulAdd(qd[i], CarriedMotion(motion, unit[i]), Times(qdd[i], unit[i])));
    force[i] = Add(Momentum(body, change), CarriedForce(motion, Momentum(body, motion)));
    const P weight = All(t.weight_mass[i]);
    const Vec3<P> moment = MulAdd(weight, f.p, Turned(f, All(t.weight_moment, i)));
    force[i].linear = MulAdd(hn::Neg(weight), g, force[i].linear);
    force[i].angular = Sub(force[i].angular, Cross(moment, g));
  });
  Outputs<kMaxChainJoints> torques;
  Six<P> sum = none;
  for (int i = t.n - 1; i >= 0; --i) {
    sum = Add(sum, force[i]);
    torques.Put(i, hn::MulAdd(All(t.armature[i]), qdd[i], Dot(unit[i], sum)));
  }
  torques.Write(lanes, t.n, out);
}

void Some(const LinkTable& t, PosePart part, const PoseQuery& query, std::size_t first, int lanes,
          double* out) {
  const std::size_t last = query.count - 1;
  const Inputs q(query.q, first, last, t.n);
  switch (part) {
    case PosePart::kTip:
      return TipsOf(t, q, lanes, out + 16 * first);
    case PosePart::kJacobian:
      return JacobiansOf(t, q, lanes, out + 6 * t.n * first);
    case PosePart::kGravity:
      return GravitiesOf(t, q, Inputs(query.gravity, first, last, 3), lanes, out + t.n * first);
    case PosePart::kMass:
      return MassesOf(t, q, lanes, out + t.n * t.n * first);
    case PosePart::kMotion:
      return MotionsOf(t, q, Inputs(query.qd, first, last, t.n),
                       Inputs(query.qdd, first, last, t.n), Inputs(query.gravity, first, last, 3),
                       lanes, out + t.n * first);
    case PosePart::kManipulability:
      return ManipulabilitiesOf(t, q, lanes, out + first);
  }
}

void ComputeAll(const LinkTable& t, PosePart part, const PoseQuery& query, double* out) {
  const std::size_t width = hn::Lanes(kPoses);
  for (std::size_t first = 0; first < query.count; first += width)
    Some(t, part, query, first, static_cast<int>(std::min(width, query.count - first)), out);
}

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell {

HWY_EXPORT(ComputeAll);

void ComputePoses(const LinkTable& table, PosePart part, const PoseQuery& query, double* out) {
  HWY_DYNAMIC_DISPATCH(ComputeAll)(table, part, query, out);
}

}  // namespace robocell
#endif
