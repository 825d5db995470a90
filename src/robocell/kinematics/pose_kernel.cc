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
#include "robocell/kinematics/link_math-inl.h"
#include "robocell/kinematics/pose_rows-inl.h"
#include "robocell/kinematics/pose_steps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Of the largest on a diagonal.
constexpr double kLeastPivot = 1e-20;

HWY_INLINE Vec3<P> TipPosition(const LinkTable& t, const Frame3<P>& last) {
  return Add(last.p, Turned(last, All(t.tip_translation)));
}

HWY_INLINE void WriteTips(const LinkTable& t, const Frame3<P>& last, const Vec3<P>& position,
                          double* out) {
  const Vec3<P> columns[4] = {Turned(last, All(t.tip_rotation)),
                              Turned(last, All(t.tip_rotation + 3)),
                              Turned(last, All(t.tip_rotation + 6)), Add(position, All(t.origin))};
  Outputs<16> tips;
  for (int c = 0; c < 4; ++c) {
    tips.Put(c, columns[c].x);
    tips.Put(4 + c, columns[c].y);
    tips.Put(8 + c, columns[c].z);
    tips.Put(12 + c, All(c == 3));
  }
  tips.Write(16, out);
}

HWY_INLINE void TipsOf(const LinkTable& t, const JointMoves& moves, double* out) {
  const Frame3<P> last = WalkPoses(t, moves, [](int, const Frame3<P>&) HWY_ATTR {});
  WriteTips(t, last, TipPosition(t, last), out);
}

// Calls visit(i, column of the Jacobian at the tip) for each joint; writes tips if they are wanted.
template <class Visit>
HWY_INLINE void VisitColumns(const LinkTable& t, const JointMoves& moves, double* tips,
                             Visit&& visit) {
  Vec3<P> axis[kMaxChainJoints], point[kMaxChainJoints];
  const Frame3<P> last = WalkPoses(t, moves, [&](int i, const Frame3<P>& f) HWY_ATTR {
    axis[i] = f.z;
    point[i] = f.p;
  });
  const Vec3<P> tip = TipPosition(t, last);
  for (int i = 0; i < t.n; ++i) {
    if (t.slides[i] != 0) {
      visit(i, Six<P>{axis[i], ZeroVector()});
    } else {
      visit(i, Six<P>{Cross(axis[i], Sub(tip, point[i])), axis[i]});
    }
  }
  if (tips) WriteTips(t, last, tip, tips);
}

HWY_INLINE void JacobiansOf(const LinkTable& t, const JointMoves& moves, double* out,
                            double* tips) {
  Outputs<6 * kMaxChainJoints> jacobian;
  const int n = t.n;
  VisitColumns(t, moves, tips, [&](int i, const Six<P>& column) HWY_ATTR {
    jacobian.Put(i, column.linear.x);
    jacobian.Put(n + i, column.linear.y);
    jacobian.Put(2 * n + i, column.linear.z);
    jacobian.Put(3 * n + i, column.angular.x);
    jacobian.Put(4 * n + i, column.angular.y);
    jacobian.Put(5 * n + i, column.angular.z);
  });
  jacobian.Write(6 * n, out);
}

// Of the Jacobian at the tip.
struct Column {
  P row[6];  // linear ones first
};

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

HWY_INLINE void ManipulabilitiesOf(const LinkTable& t, const JointMoves& moves, double* out) {
  Column columns[kMaxChainJoints];
  VisitColumns(t, moves, nullptr, [&](int i, const Six<P>& c) HWY_ATTR {
    columns[i] = {{c.linear.x, c.linear.y, c.linear.z, c.angular.x, c.angular.y, c.angular.z}};
  });
  P square[6][6];
  const int rows = SquaredOf(columns, t.n, square);
  Outputs<1> values;
  values.Put(0, RootOfDeterminant(square, rows));
  values.Write(1, out);
}

HWY_INLINE Vec3<P> Three(const Inputs& in) { return {in[0], in[1], in[2]}; }

// In the frames of the joints: gravity from the base on, what is behind a joint from the tip on.
HWY_INLINE void GravitiesOf(const LinkTable& t, const JointMoves& moves, const Inputs& gravity,
                            double* out) {
  Vec3<P> g[kMaxChainJoints];
  for (int i = 0; i < t.n; ++i) g[i] = SeenFrom(t, i, moves, i == 0 ? Three(gravity) : g[i - 1]);
  Outputs<kMaxChainJoints> torques;
  Vec3<P> moment = All(t.weight_moment, t.n - 1);
  for (int i = t.n - 1; i >= 0; --i) {
    const P mass = All(t.weight_behind[i]);
    torques.Put(i, t.slides[i] != 0 ? hn::Neg(hn::Mul(mass, g[i].z))
                                    : hn::MulSub(moment.y, g[i].x, hn::Mul(moment.x, g[i].y)));
    if (i == 0) break;
    if (t.slides[i] != 0) moment.z = hn::MulAdd(mass, moves.shift(i), moment.z);
    moment = MulAdd(mass, All(t.translation, i), Back(t, i, moves, moment));
    moment = Add(moment, All(t.weight_moment, i - 1));
  }
  torques.Write(t.n, out);
}

HWY_INLINE RigidBody<P> LinkOf(const LinkTable& t, int i) {
  const auto at = [&](int k) HWY_ATTR { return All(t.inertia[k][i]); };
  return {All(t.mass[i]), All(t.moment, i), {at(0), at(1), at(2), at(3), at(4), at(5)}};
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

// The momentum of a body that a joint moves with speed 1, in the joint's frame.
HWY_INLINE Six<P> MomentumAlong(bool slide, const RigidBody<P>& body) {
  const P zero = hn::Zero(kPoses);
  const Vec3<P>& h = body.moment;
  if (slide) return {{zero, zero, body.mass}, {h.y, hn::Neg(h.x), zero}};
  return {{hn::Neg(h.y), h.x, zero}, {body.inertia.xz, body.inertia.yz, body.inertia.zz}};
}

// Composite bodies in the frames of the joints, from the tip on; what one joint's motion needs of
// those before it is carried back to them (R. Featherstone, "Rigid Body Dynamics Algorithms", 2008,
// section 6.2).
HWY_INLINE void MassesOf(const LinkTable& t, const JointMoves& moves, double* out) {
  Outputs<kMaxChainJoints * kMaxChainJoints> mass;
  RigidBody<P> behind = LinkOf(t, t.n - 1);
  for (int j = t.n - 1;; --j) {
    behind.mass = All(t.mass_behind[j]);
    Six<P> momentum = MomentumAlong(t.slides[j] != 0, behind);
    for (int i = j;; --i) {
      P entry = t.slides[i] != 0 ? momentum.linear.z : momentum.angular.z;
      if (i == j) entry = hn::Add(entry, All(t.armature[j]));
      mass.Put(i * t.n + j, entry);
      mass.Put(j * t.n + i, entry);
      if (i == 0) break;
      momentum = Back(t, i, moves, momentum);
    }
    if (j == 0) break;
    behind = Back(t, j, moves, behind);
    Include(LinkOf(t, j - 1), &behind);
  }
  mass.Write(t.n * t.n, out);
}

HWY_INLINE void MotionsOf(const LinkTable& t, const JointMoves& moves, const Inputs& qd,
                          const Inputs& qdd, const Inputs& gravity, double* out) {
  Six<P> unit[kMaxChainJoints], force[kMaxChainJoints];
  const P zero = hn::Zero(kPoses);
  const Six<P> none{{zero, zero, zero}, {zero, zero, zero}};
  Six<P> motion = none, change = none;
  const Vec3<P> g = Three(gravity);
  WalkPoses(t, moves, [&](int i, const Frame3<P>& f) HWY_ATTR {
    unit[i] = UnitOf(t, i, f);
    const RigidBody<P> body = InParent(f, LinkOf(t, i));
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
  torques.Write(t.n, out);
}

// How many numbers an answer is.
int NumbersOf(PosePart part, int n) {
  switch (part) {
    case PosePart::kTip:
      return 16;
    case PosePart::kJacobian:
      return 6 * n;
    case PosePart::kGravity:
    case PosePart::kMotion:
      return n;
    case PosePart::kMass:
      return n * n;
    case PosePart::kManipulability:
      return 1;
  }
  return 0;
}
constexpr int kMostNumbers = kMaxChainJoints * kMaxChainJoints;
static_assert(kMaxChainJoints >= 6);

// Answers of all lanes.
void Some(const LinkTable& t, PosePart part, const PoseQuery& query, std::size_t first, double* out,
          double* tips) {
  const std::size_t last = query.count - 1;
  const JointMoves moves(t, Inputs(query.q, first, last, t.n));
  switch (part) {
    case PosePart::kTip:
      return TipsOf(t, moves, out);
    case PosePart::kJacobian:
      return JacobiansOf(t, moves, out, tips);
    case PosePart::kGravity:
      return GravitiesOf(t, moves, Inputs(query.gravity, first, last, 3), out);
    case PosePart::kMass:
      return MassesOf(t, moves, out);
    case PosePart::kMotion:
      return MotionsOf(t, moves, Inputs(query.qd, first, last, t.n),
                       Inputs(query.qdd, first, last, t.n), Inputs(query.gravity, first, last, 3),
                       out);
    case PosePart::kManipulability:
      return ManipulabilitiesOf(t, moves, out);
  }
}

void ComputeAll(const LinkTable& t, PosePart part, const PoseQuery& query, double* out,
                double* tips) {
  const std::size_t numbers = NumbersOf(part, t.n);
  const std::size_t rest = query.count % kWidth, whole = query.count - rest;
  for (std::size_t first = 0; first < whole; first += kWidth)
    Some(t, part, query, first, out + first * numbers, tips ? tips + first * 16 : nullptr);
  if (rest == 0) return;
  alignas(64) double last[kWidth * kMostNumbers], last_tips[kWidth * 16];
  Some(t, part, query, whole, last, tips ? last_tips : nullptr);
  std::copy_n(last, rest * numbers, out + whole * numbers);
  if (tips) std::copy_n(last_tips, rest * 16, tips + whole * 16);
}

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell {

HWY_EXPORT(ComputeAll);

void ComputePoses(const LinkTable& table, PosePart part, const PoseQuery& query, double* out,
                  double* tips) {
  HWY_DYNAMIC_DISPATCH(ComputeAll)(table, part, query, out, tips);
}

}  // namespace robocell
#endif
