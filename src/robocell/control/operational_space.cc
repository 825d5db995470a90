#include "robocell/control/operational_space.h"

#include "robocell/kinematics/link_kernel.h"

#include <algorithm>
#include <cmath>

#include "robocell/control/inverse_root.h"
#include "robocell/kinematics/pose_error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/control/operational_space.cc"
// The targets of lane_kernel.cc, but AVX-512 only in its later form (Zen 4, Ice Lake).
#define HWY_WANT_AVX3_DL
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/kinematics/lane_quad-inl.h"
#include "robocell/kinematics/lane_six-inl.h"

namespace robocell {
// Handles large rotations, on all instruction sets.
void FarTurn(const double (*from)[4], const double* to, double* out);
// True if a few instructions on eight numbers do not lower the clock of the processor, at which the
// engine steps beside this code. On Zen 4 they save 0.05 us of a control tick; on Intel's
// processors they have cost a step more than they gained (link_kernel.cc).
extern const bool kEightAtOnce;
}  // namespace robocell

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
using namespace internal::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

// Eight numbers in a register, or as many as fit; Fours has four.
using Eights = hn::CappedTag<double, 8>;
template <class D>
HWY_INLINE double LastOf(D, const hn::Vec<D>& v) {
  return hn::ExtractLane(v, hn::MaxLanes(D()) - 1);
}
// One number in a register, so that products and sums are fused as in the lanes.
using One = hn::CappedTag<double, 1>;
constexpr One kOne;
// A symmetric matrix during the computation: rows of the left and the right half, with a valid
// lower triangle.
using Halves = double[6][8];
HWY_INLINE double& At(Halves& m, int row, int column) {
  return m[row][column < 3 ? column : column + 1];
}

// The motion of the leaf by each joint at unit speed: the columns of a Jacobian.
struct Columns {
  alignas(64) double linear[kMaxChainJoints][4];
  alignas(64) double angular[kMaxChainJoints][4];
};

// Loads the halves of a register that the rows were stored with: a wider load would wait for them.
HWY_INLINE void MakeColumns(int n, const LinkTable::Row* rows, Columns* columns) {
  const auto zero = hn::Zero(kFours);
  const auto at = [&](int row, int i) HWY_ATTR { return hn::Load(kFours, rows[row] + i); };
  for (int i = 0; i < n; i += hn::MaxLanes(kFours)) {
    hn::StoreInterleaved4(at(0, i), at(1, i), at(2, i), zero, kFours, columns->linear[i]);
    hn::StoreInterleaved4(at(3, i), at(4, i), at(5, i), zero, kFours, columns->angular[i]);
  }
}

// Computes the rotation vector from axes to others. Twice the sine of the angle, along the axis, is
// the sum of the cross products; 1 + 2 cosine is that of the scalar products.
HWY_INLINE void Turn(const Quad* from, const double* to, double* out) {
  Quad crosses = ZeroQuad(), products = ZeroQuad();
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    const Quad there = ThreeAt(to + 3 * k);
    crosses = Add(crosses, UnturnedCross(from[k], there));
    products = MulAdd(from[k], there, products);
  }
  const double trace = SumOf(products), half_sine2 = 0.25 * (3 - trace);
  if (half_sine2 < 0.0625) {
    const double half_cosine = std::sqrt(0.25 * (1 + trace));
    PutAnywhere(Times(internal::HalfAngleBySine(half_sine2) / half_cosine, Yzx(crosses)), out);
    return;
  }
  alignas(32) double here[3][4];
  for (int k = 0; k < 3; ++k) Put(from[k], here[k]);
  FarTurn(here, to, out);
}

// Computes the pose error of the leaf; `out` has space for a seventh number.
HWY_INLINE void MakeDeviation(const internal::LinkAnswer& arm, const TcpTarget& goal, double* out) {
  const Quad from[3] = {QuadAt(arm.tip[0]), QuadAt(arm.tip[1]), QuadAt(arm.tip[2])};
  PutAnywhere(Sub(ThreeAt(goal.position), QuadAt(arm.tip[3])), out);
  Turn(from, goal.axes, out + 3);
}

// Computes the velocity and another motion of the leaf from those of the joints.
HWY_INLINE void LeafMotions(const Columns& columns, const OperationalSpaceQuery& query,
                            double* velocity, double* wanted) {
  Quad sums[4];
  for (Quad& sum : sums) sum = ZeroQuad();
  for (int i = 0; i < query.n; ++i) {
    const Quad linear = QuadAt(columns.linear[i]), angular = QuadAt(columns.angular[i]);
    sums[0] = MulAdd(query.velocity[i], linear, sums[0]);
    sums[1] = MulAdd(query.velocity[i], angular, sums[1]);
    sums[2] = MulAdd(query.wanted[i], linear, sums[2]);
    sums[3] = MulAdd(query.wanted[i], angular, sums[3]);
  }
  // Writes six numbers each, and a last one that is overwritten.
  PutAnywhere(sums[0], velocity);
  PutAnywhere(sums[1], velocity + 3);
  PutAnywhere(sums[2], wanted);
  PutAnywhere(sums[3], wanted + 3);
}

// Computes (L^-1 J^T)^T and 1 / D, where mass = L D L^T. With a constant number of joints the mass
// stays in registers.
template <int N>
HWY_INLINE void Eliminate(int joints, const LinkTable::Row* mass, const Columns& columns,
                          Columns* out, double* inverse) {
  const int n = N ? N : joints;
  constexpr int kMost = N ? N : kMaxChainJoints;
  hn::Vec<One> m[kMost][kMost];
#pragma GCC unroll 7
  for (int i = 0; i < n; ++i) {
#pragma GCC unroll 7
    for (int k = 0; k <= i; ++k) m[i][k] = hn::Set(kOne, mass[i][k]);
  }
#pragma GCC unroll 1
  for (int i = 0; i < n; ++i) {
    Put(QuadAt(columns.linear[i]), out->linear[i]);
    Put(QuadAt(columns.angular[i]), out->angular[i]);
  }
  hn::Vec<One> reciprocal[kMost];  // negated
#pragma GCC unroll 7
  for (int k = 0; k < n; ++k) {
    // Two at a time, as in SolveSix.
    if (k % 2 == 0) {
      const auto first = m[k][k];
      reciprocal[k] = hn::Div(hn::Set(kOne, -1.0), first);
      if (k + 1 < n) {
        const auto minor = hn::NegMulAdd(m[k + 1][k], m[k + 1][k], hn::Mul(first, m[k + 1][k + 1]));
        reciprocal[k + 1] = hn::Mul(first, hn::Div(hn::Set(kOne, -1.0), minor));
      }
    }
    inverse[k] = -hn::GetLane(reciprocal[k]);
    const Quad linear = QuadAt(out->linear[k]), angular = QuadAt(out->angular[k]);
#pragma GCC unroll 7
    for (int i = k + 1; i < n; ++i) {
      const auto factor = hn::Mul(m[i][k], reciprocal[k]);
#pragma GCC unroll 7
      for (int j = k + 1; j <= i; ++j) m[i][j] = hn::MulAdd(factor, m[j][k], m[i][j]);
      const double f = hn::GetLane(factor);
      Put(MulAdd(f, linear, QuadAt(out->linear[i])), out->linear[i]);
      Put(MulAdd(f, angular, QuadAt(out->angular[i])), out->angular[i]);
    }
  }
}

HWY_INLINE void InverseInertiaOf(int n, const LinkTable::Row* mass, const Columns& columns,
                                 Columns* eliminated, Halves& inverse_inertia) {
  double inverse[kMaxChainJoints];
  switch (n) {
    case 6:
      Eliminate<6>(n, mass, columns, eliminated, inverse);
      break;
    case 7:
      Eliminate<7>(n, mass, columns, eliminated, inverse);
      break;
    default:
      Eliminate<0>(n, mass, columns, eliminated, inverse);
  }
  // The rows of the left and the right half; the upper right part is not needed.
  alignas(32) constexpr double kUnit[3][4] = {{1}, {0, 1}, {0, 0, 1}};
  Quad left[6], right[6];
#pragma GCC unroll 3
  for (int r = 0; r < 3; ++r) {
    left[r] = right[r + 3] = Times(kLeastInverseInertia, QuadAt(kUnit[r]));
    left[r + 3] = ZeroQuad();
  }
  for (int k = 0; k < n; ++k) {
    const Quad linear = QuadAt(eliminated->linear[k]), angular = QuadAt(eliminated->angular[k]);
    alignas(32) double up[4], down[4];
    Put(Times(inverse[k], linear), up);
    Put(Times(inverse[k], angular), down);
#pragma GCC unroll 3
    for (int r = 0; r < 3; ++r) {
      left[r] = MulAdd(up[r], linear, left[r]);
      left[r + 3] = MulAdd(down[r], linear, left[r + 3]);
      right[r + 3] = MulAdd(down[r], angular, right[r + 3]);
    }
  }
#pragma GCC unroll 3
  for (int r = 0; r < 3; ++r) {
    Put(left[r], inverse_inertia[r]);
    Put(left[r + 3], inverse_inertia[r + 3]);
    Put(right[r + 3], inverse_inertia[r + 3] + 4);
  }
}

// Multiplies a symmetric matrix by a vector, without waiting for the divisors.
template <int N>
HWY_INLINE void MassTimes(int joints, const LinkTable::Row* mass, const double* vector,
                          double* out) {
  const int n = N ? N : joints;
  constexpr int kMost = N ? N : kMaxChainJoints;
  hn::Vec<One> v[kMost], sums[kMost];
#pragma GCC unroll 7
  for (int i = 0; i < n; ++i) {
    v[i] = hn::Set(kOne, vector[i]);
    sums[i] = hn::Mul(v[i], hn::Set(kOne, mass[i][i]));
#pragma GCC unroll 7
    for (int k = 0; k < i; ++k) {
      const auto m = hn::Set(kOne, mass[i][k]);
      sums[i] = hn::MulAdd(m, v[k], sums[i]);
      sums[k] = hn::MulAdd(m, v[i], sums[k]);
    }
  }
#pragma GCC unroll 7
  for (int i = 0; i < n; ++i) out[i] = hn::GetLane(sums[i]);
}

HWY_INLINE void MassTimesAny(int n, const LinkTable::Row* mass, const double* vector, double* out) {
  switch (n) {
    case 6:
      return MassTimes<6>(n, mass, vector, out);
    case 7:
      return MassTimes<7>(n, mass, vector, out);
    default:
      return MassTimes<0>(n, mass, vector, out);
  }
}

// The damping and the forces on the leaf before they are combined.
struct Damped {
  double determinant = 1;  // determinant of inverse_inertia
  double along[6] = {};
  double inertial_force[6] = {};
};

// The motion to be damped and the requested one.
struct Motion {
  const TcpSprings& springs;
  Halves& inverse_inertia;
  double top;
  const double* velocity;
  const double* wanted;
};

// Computes the share of as many poles as a register has lanes, from `first` on. A lane without a
// pole solves for `wanted`, in the axes of the base. It is a function of its own: repeated code
// finds its instructions in the cache, which a control tick has to load for everything that runs
// once.
template <class D>
HWY_NOINLINE void DampByPoles(D d, const Motion& motion, const internal::InverseRoot& root,
                              int first, Damped* out) {
  using V = hn::Vec<D>;
  const auto is_pole = hn::FirstN(d, static_cast<size_t>(root.n_poles - first));
  V a[kEntries], b[6], scale[6];
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    const double spring = motion.springs.root[k];
    scale[k] = hn::IfThenElse(is_pole, hn::Set(d, spring), hn::Set(d, 1.0));
    b[k] = hn::IfThenElse(is_pole, hn::Set(d, spring * motion.velocity[k]),
                          hn::Set(d, motion.wanted[k]));
  }
  const V shift = hn::Mul(hn::Set(d, motion.top), hn::Load(d, root.shift + first));
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r) {
#pragma GCC unroll 6
    for (int c = 0; c <= r; ++c) {
      a[Entry(r, c)] =
          hn::Mul(hn::Mul(scale[r], scale[c]), hn::Set(d, At(motion.inverse_inertia, r, c)));
    }
    a[Entry(r, r)] = hn::Add(a[Entry(r, r)], shift);
  }
  out->determinant = LastOf(d, SolveSix(hn::Set(d, 1.0), a, b));
  const V weight = hn::Load(d, root.weight + first);
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    out->along[k] += hn::GetLane(hn::SumOfLanes(d, hn::Mul(weight, b[k])));
    out->inertial_force[k] = LastOf(d, b[k]);
  }
}

template <class D>
HWY_INLINE void DampByRegisters(D d, const Motion& motion, const internal::InverseRoot& root,
                                Damped* out) {
  const int padded = (root.n_poles + 7) / 8 * 8;
  for (int first = 0; first < padded; first += hn::MaxLanes(d))
    DampByPoles(d, motion, root, first, out);
}

HWY_INLINE void DampBy(const Motion& motion, const internal::InverseRoot& root, Damped* out) {
#if HWY_TARGET == HWY_AVX3_DL
  if (kEightAtOnce) return DampByRegisters(Eights(), motion, root, out);
#endif
  DampByRegisters(kFours, motion, root, out);
}

// Returns a lower bound of the eigenvalues of the inverse_inertia in coordinates in which all
// springs are equal: the trace of its inverse is the sum of their reciprocals. Only axes with
// springs count.
HWY_NOINLINE double LeastEigenvalue(const TcpSprings& springs, Halves& inverse_inertia) {
  alignas(64) constexpr double kUnit[6][8] = {{1},          {0, 1},          {0, 0, 1},
                                              {0, 0, 0, 1}, {0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 1}};
  constexpr int kLanes = hn::MaxLanes(kFours);
  double trace = 0;
  for (int first = 0; first < 6; first += kLanes) {
    hn::Vec<Fours> a[kEntries], b[6];
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) {
#pragma GCC unroll 6
      for (int c = 0; c <= r; ++c) a[Entry(r, c)] = hn::Set(kFours, At(inverse_inertia, r, c));
      b[r] = hn::Load(kFours, kUnit[r] + first);
    }
    SolveSix(hn::Set(kFours, 1.0), a, b);
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k) {
      alignas(64) double inverse[kLanes];
      hn::Store(b[k], kFours, inverse);
      const bool here = first <= k && k < first + kLanes;
      if (here && springs.stiffness[k] > 0) trace += inverse[k - first] / springs.stiffness[k];
    }
  }
  return 1 / trace;
}

HWY_INLINE const internal::InverseRoot& RootFor(double range) {
  const internal::InverseRoot* roots = internal::InverseRoots();
  for (int k = 0; k < internal::kInverseRoots - 1; ++k) {
    if (range <= roots[k].range) return roots[k];
  }
  return roots[internal::kInverseRoots - 1];
}

// Also computes the force that accelerates the leaf as requested.
HWY_INLINE void Damp(const TcpSprings& springs, Halves& inverse_inertia, const double* velocity,
                     const double* wanted, double* damping, double* inertial_force) {
  double trace = 0, stiffnesses = 1;
  for (int k = 0; k < 6; ++k) {
    trace += springs.stiffness[k] * At(inverse_inertia, k, k);
    stiffnesses *= springs.stiffness[k];
  }
  const double top = trace > 0 ? trace : 1;  // no springs: nothing is damped
  const Motion motion{springs, inverse_inertia, top, velocity, wanted};
  Damped damped;
  DampBy(motion, internal::InverseRoots()[0], &damped);
  // Each eigenvalue is at least the determinant divided by the largest possible product of the
  // others. A weak bound is improved.
  const double share = 5 / top, share2 = share * share;
  const double least = damped.determinant * stiffnesses * share2 * share2 * share;
  if (!(top <= internal::InverseRoots()[0].range * least) && trace > 0) {
    const internal::InverseRoot& root = RootFor(top / LeastEigenvalue(springs, inverse_inertia));
    if (&root != internal::InverseRoots()) {
      Damped widely;
      DampBy(motion, root, &widely);
      std::copy_n(widely.along, 6, damped.along);
    }
  }
  const double twice = 2 * std::sqrt(top);
  for (int k = 0; k < 6; ++k) {
    damping[k] = twice * springs.root[k] * damped.along[k];
    inertial_force[k] = damped.inertial_force[k];
  }
}

// `moving` has the torques for the requested joint accelerations.
HWY_INLINE void TorquesOf(const OperationalSpaceQuery& query, const Columns& columns,
                          const double* deviation, const double* moving,
                          OperationalSpaceResult* out) {
  hn::Vec<One> force[6];
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    // Redundant joints must not push the TCP.
    force[k] = hn::Set(kOne, query.springs->stiffness[k] * deviation[k] -
                                 query.damping_ratio * out->damping[k] + query.feedforward[k] -
                                 out->inertial_force[k]);
  }
  for (int i = 0; i < query.n; ++i) {
    auto linear = hn::Set(kOne, query.arm->torques[i]), angular = hn::Set(kOne, moving[i]);
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      linear = hn::MulAdd(force[k], hn::Set(kOne, columns.linear[i][k]), linear);
      angular = hn::MulAdd(force[k + 3], hn::Set(kOne, columns.angular[i][k]), angular);
    }
    out->torques[i] = hn::GetLane(hn::Add(linear, angular));
  }
}

void Leaf(const OperationalSpaceQuery& query, OperationalSpaceResult* out) {
  const internal::LinkAnswer& arm = *query.arm;
  Columns columns, eliminated;
  MakeColumns(query.n, arm.jacobian, &columns);
  double velocity[7], wanted[7], deviation[7];
  LeafMotions(columns, query, velocity, wanted);
  MakeDeviation(arm, query.goal, deviation);
  alignas(32) Halves inverse_inertia;
  InverseInertiaOf(query.n, arm.mass, columns, &eliminated, inverse_inertia);
  double moving[kMaxChainJoints];
  MassTimesAny(query.n, arm.mass, query.wanted, moving);
  Damp(*query.springs, inverse_inertia, velocity, wanted, out->damping, out->inertial_force);
  TorquesOf(query, columns, deviation, moving, out);
}

void Deviation(const internal::LinkAnswer& arm, const TcpTarget& goal, double* deviation) {
  double room[7];
  MakeDeviation(arm, goal, room);
  for (int k = 0; k < 6; ++k) deviation[k] = room[k];
}

void InverseInertia(int n, const internal::LinkAnswer& arm, double* inverse_inertia) {
  Columns columns, eliminated;
  MakeColumns(n, arm.jacobian, &columns);
  alignas(32) Halves halves;
  InverseInertiaOf(n, arm.mass, columns, &eliminated, halves);
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c <= r; ++c) inverse_inertia[Entry(r, c)] = At(halves, r, c);
  }
}

void DampAlone(const double* stiffness, const double* inverse_inertia, const double* velocity,
               double* out) {
  alignas(32) Halves halves;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c <= r; ++c) At(halves, r, c) = inverse_inertia[Entry(r, c)];
  }
  const double wanted[6] = {};
  double inertial_force[6];
  Damp(MakeTcpSprings(stiffness), halves, velocity, wanted, out, inertial_force);
}

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell {

#if HWY_ARCH_X86
const bool kEightAtOnce = __builtin_cpu_is("amd");
#endif

void FarTurn(const double (*from)[4], const double* to, double* out) {
  Eigen::Matrix3d here;
  for (int k = 0; k < 3; ++k) here.col(k) = Eigen::Map<const Eigen::Vector3d>(from[k]);
  Eigen::Map<Eigen::Vector3d>{out} =
      internal::RotationVector(Eigen::Map<const Eigen::Matrix3d>(to) * here.transpose());
}

HWY_EXPORT(Leaf);
HWY_EXPORT(Deviation);
HWY_EXPORT(InverseInertia);
HWY_EXPORT(DampAlone);

TcpSprings MakeTcpSprings(const double* stiffness) {
  TcpSprings springs;
  for (int k = 0; k < 6; ++k) {
    springs.stiffness[k] = stiffness[k];
    springs.root[k] = std::sqrt(stiffness[k]);
  }
  return springs;
}

void ComputeOperationalSpace(const OperationalSpaceQuery& query, OperationalSpaceResult* out) {
  HWY_DYNAMIC_DISPATCH(Leaf)(query, out);
}
void ComputeDeviation(const internal::LinkAnswer& arm, const TcpTarget& goal, double* deviation) {
  HWY_DYNAMIC_DISPATCH(Deviation)(arm, goal, deviation);
}
void ComputeInverseInertia(int n, const internal::LinkAnswer& arm, double* inverse_inertia) {
  HWY_DYNAMIC_DISPATCH(InverseInertia)(n, arm, inverse_inertia);
}
void CriticalDamping(const double* stiffness, const double* inverse_inertia, const double* velocity,
                     double* out) {
  HWY_DYNAMIC_DISPATCH(DampAlone)(stiffness, inverse_inertia, velocity, out);
}

}  // namespace robocell
#endif
