#include "robocell/control/leaf_kernel.h"

#include <cmath>

#include "robocell/control/inverse_root.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/control/leaf_kernel.cc"
// As in link_kernel.cc.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | (HWY_AVX2 - 1) | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/kinematics/lane_eight-inl.h"
#include "robocell/kinematics/lane_quad-inl.h"
#include "robocell/kinematics/lane_six-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One number in a register, so that products and sums are fused as in the lanes.
using One = hn::CappedTag<double, 1>;
constexpr One kOne;
// A symmetric matrix while it is at work here: rows of the left and the right half, the lower
// triangle good.
using Halves = double[6][8];
HWY_INLINE double& At(Halves& m, int row, int column) {
  return m[row][column < 3 ? column : column + 1];
}

// Where the leaf is moved by each joint at unit speed: the columns of a Jacobian.
struct Columns {
  alignas(64) double linear[kMaxChainJoints][4];
  alignas(64) double angular[kMaxChainJoints][4];
};

// Of a vector in the axes of the world, which are in those of the base `axes`.
HWY_INLINE Quad InBase(const double* v, const Quad* axes) {
  return MulAdd(v[0], axes[0], MulAdd(v[1], axes[1], Times(v[2], axes[2])));
}

HWY_INLINE void MakeColumns(const LeafView& view, Columns* columns) {
  alignas(32) double rows[3][4] = {};
  Quad axes[3];
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < 3; ++c) rows[k][c] = view.base_rotation[3 * k + c];
    axes[k] = QuadAt(rows[k]);
  }
  const Quad leaf = InBase(view.leaf_position, axes);
  for (int i = 0; i < view.n; ++i) {
    const int at = 3 * view.joints[i];
    const Quad axis = InBase(view.axes + at, axes);
    const bool slides = view.slides[i];
    Put(slides ? axis : Cross(axis, Sub(leaf, InBase(view.anchors + at, axes))),
        columns->linear[i]);
    Put(slides ? ZeroQuad() : axis, columns->angular[i]);
  }
}

// Velocity and another motion of the leaf, with the joints'.
HWY_INLINE void LeafMotions(const Columns& columns, const LeafQuery& query, double* velocity,
                            double* wanted) {
  Quad sums[4];
  for (Quad& sum : sums) sum = ZeroQuad();
  for (int i = 0; i < query.view.n; ++i) {
    const Quad linear = QuadAt(columns.linear[i]), angular = QuadAt(columns.angular[i]);
    sums[0] = MulAdd(query.velocity[i], linear, sums[0]);
    sums[1] = MulAdd(query.velocity[i], angular, sums[1]);
    sums[2] = MulAdd(query.wanted[i], linear, sums[2]);
    sums[3] = MulAdd(query.wanted[i], angular, sums[3]);
  }
  // Six numbers each, and a last one that is written over.
  PutAnywhere(sums[0], velocity);
  PutAnywhere(sums[1], velocity + 3);
  PutAnywhere(sums[2], wanted);
  PutAnywhere(sums[3], wanted + 3);
}

// With mass = L D L^T: (L^-1 J^T)^T, and 1 / D. For a number of joints that is known here, the mass
// stays in registers.
template <int N>
HWY_INLINE void Eliminate(int joints, const double* mass, const Columns& columns, Columns* out,
                          double* inverse) {
  const int n = N ? N : joints;
  constexpr int kMost = N ? N : kMaxChainJoints;
  hn::Vec<One> m[kMost][kMost];
#pragma GCC unroll 7
  for (int i = 0; i < n; ++i) {
#pragma GCC unroll 7
    for (int k = 0; k <= i; ++k) m[i][k] = hn::Set(kOne, mass[Entry(i, k)]);
  }
#pragma GCC unroll 1
  for (int i = 0; i < n; ++i) {
    Put(QuadAt(columns.linear[i]), out->linear[i]);
    Put(QuadAt(columns.angular[i]), out->angular[i]);
  }
  hn::Vec<One> reciprocal[kMost];  // negative ones
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

HWY_INLINE void MobilityOf(int n, const double* mass, const Columns& columns, Columns* eliminated,
                           Halves& mobility) {
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
  // Rows, the left and the right half; upper right ones are not needed.
  alignas(32) constexpr double kUnit[3][4] = {{1}, {0, 1}, {0, 0, 1}};
  Quad left[6], right[6];
#pragma GCC unroll 3
  for (int r = 0; r < 3; ++r) {
    left[r] = right[r + 3] = Times(kLeastMobility, QuadAt(kUnit[r]));
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
    Put(left[r], mobility[r]);
    Put(left[r + 3], mobility[r + 3]);
    Put(right[r + 3], mobility[r + 3] + 4);
  }
}

// The mobility in the coordinates of each lane, with a shift.
HWY_INLINE void SetUp(const Eight* scale, Halves& mobility, const Eight& shift, Eight* a) {
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r) {
#pragma GCC unroll 6
    for (int c = 0; c <= r; ++c)
      a[Entry(r, c)] = Mul(Mul(scale[r], scale[c]), EightTimes(At(mobility, r, c)));
    a[Entry(r, r)] = Add(a[Entry(r, r)], shift);
  }
}

// A symmetric matrix times a vector, which do not wait for what is divided by.
template <int N>
HWY_INLINE void MassTimes(int joints, const double* mass, const double* vector, double* out) {
  const int n = N ? N : joints;
  constexpr int kMost = N ? N : kMaxChainJoints;
  hn::Vec<One> v[kMost], sums[kMost];
#pragma GCC unroll 7
  for (int i = 0; i < n; ++i) {
    v[i] = hn::Set(kOne, vector[i]);
    sums[i] = hn::Mul(v[i], hn::Set(kOne, mass[Entry(i, i)]));
#pragma GCC unroll 7
    for (int k = 0; k < i; ++k) {
      const auto m = hn::Set(kOne, mass[Entry(i, k)]);
      sums[i] = hn::MulAdd(m, v[k], sums[i]);
      sums[k] = hn::MulAdd(m, v[i], sums[k]);
    }
  }
#pragma GCC unroll 7
  for (int i = 0; i < n; ++i) out[i] = hn::GetLane(sums[i]);
}

HWY_INLINE void MassTimesAny(int n, const double* mass, const double* vector, double* out) {
  switch (n) {
    case 6:
      return MassTimes<6>(n, mass, vector, out);
    case 7:
      return MassTimes<7>(n, mass, vector, out);
    default:
      return MassTimes<0>(n, mass, vector, out);
  }
}

struct Damped {
  double determinant = 1;  // of the mobility
  double along[6], felt[6];
};

// With the first of the inverse roots, whose last lane, without a shift, solves for `wanted`.
HWY_INLINE Damped DampAndFeel(const LeafSprings& springs, Halves& mobility, double top,
                              const double* velocity, const double* wanted) {
  const InverseRoot& root = InverseRoots()[0];
  Eight a[kEntries], b[6], scale[6];
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    scale[k] = WithLast(EightTimes(springs.root[k]), 1);  // in the last those of the base
    b[k] = Mul(scale[k], WithLast(EightTimes(velocity[k]), wanted[k]));
  }
  SetUp(scale, mobility, Mul(EightTimes(top), EightAt(root.shift)), a);
  Damped out;
  out.determinant = LastOf(SolveSix(EightTimes(1), a, b));
  const Eight weight = EightAt(root.weight);
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    out.along[k] = SumOf(Mul(weight, b[k]));
    out.felt[k] = LastOf(b[k]);
  }
  return out;
}

// What no eigenvalue is less than, of the mobility in coordinates in which all springs are alike:
// the trace of its inverse is the sum of what is one over them. Of no axes but those with springs.
HWY_NOINLINE double LeastEigenvalue(const LeafSprings& springs, Halves& mobility) {
  alignas(64) constexpr double kUnit[6][8] = {{1},          {0, 1},          {0, 0, 1},
                                              {0, 0, 0, 1}, {0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 1}};
  Eight a[kEntries], b[6];
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r) {
#pragma GCC unroll 6
    for (int c = 0; c <= r; ++c) a[Entry(r, c)] = EightTimes(At(mobility, r, c));
    b[r] = EightAt(kUnit[r]);
  }
  SolveSix(EightTimes(1), a, b);
  double trace = 0;
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    alignas(64) double inverse[8];
    Put(b[k], inverse);
    if (springs.stiffness[k] > 0) trace += inverse[k] / springs.stiffness[k];
  }
  return 1 / trace;
}

// With one of the inverse roots of more poles.
HWY_NOINLINE void DampWidely(const LeafSprings& springs, Halves& mobility, double top,
                             const double* velocity, const InverseRoot& root, double* along) {
  Eight sums[6], a[kEntries], b[6], scale[6];
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    sums[k] = EightTimes(0);
    scale[k] = EightTimes(springs.root[k]);
  }
  for (int first = 0; first < root.n_poles; first += 8) {
    SetUp(scale, mobility, Mul(EightTimes(top), EightAt(root.shift + first)), a);
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k) b[k] = Mul(scale[k], EightTimes(velocity[k]));
    SolveSix(EightTimes(1), a, b);
    const Eight weight = EightAt(root.weight + first);
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k) sums[k] = MulAdd(weight, b[k], sums[k]);
  }
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) along[k] = SumOf(sums[k]);
}

HWY_INLINE const InverseRoot& RootFor(double range) {
  const InverseRoot* roots = InverseRoots();
  for (int k = 0; k < kInverseRoots - 1; ++k) {
    if (range <= roots[k].range) return roots[k];
  }
  return roots[kInverseRoots - 1];
}

// And the force that accelerates the leaf as wanted.
HWY_INLINE void Damp(const LeafSprings& springs, Halves& mobility, const double* velocity,
                     const double* wanted, double* damping, double* felt) {
  double trace = 0, stiffnesses = 1;
  for (int k = 0; k < 6; ++k) {
    trace += springs.stiffness[k] * At(mobility, k, k);
    stiffnesses *= springs.stiffness[k];
  }
  const double top = trace > 0 ? trace : 1;  // no springs: nothing is damped
  Damped damped = DampAndFeel(springs, mobility, top, velocity, wanted);
  // No eigenvalue is less than what the others, as large as they can be together, leave of the
  // determinant. Where that says little, there is more to know.
  const double share = 5 / top, share2 = share * share;
  const double least = damped.determinant * stiffnesses * share2 * share2 * share;
  if (!(top <= InverseRoots()[0].range * least) && trace > 0) {
    const InverseRoot& root = RootFor(top / LeastEigenvalue(springs, mobility));
    if (&root != InverseRoots()) DampWidely(springs, mobility, top, velocity, root, damped.along);
  }
  const double twice = 2 * std::sqrt(top);
  for (int k = 0; k < 6; ++k) {
    damping[k] = twice * springs.root[k] * damped.along[k];
    felt[k] = damped.felt[k];
  }
}

// `moving` is what the joints need to accelerate as wanted.
HWY_INLINE void TorquesOf(const LeafQuery& query, const Columns& columns, const double* moving,
                          LeafAnswer* out) {
  alignas(32) double force[8] = {}, torque[8] = {};
  for (int k = 0; k < 6; ++k) {
    // What the joints to spare do is not to be felt.
    (k < 3 ? force[k] : torque[k - 3]) = query.springs->stiffness[k] * query.deviation[k] -
                                         query.damping_ratio * out->damping[k] +
                                         query.feedforward[k] - out->felt[k];
  }
  const Quad linear = QuadAt(force), angular = QuadAt(torque);
  for (int i = 0; i < query.view.n; ++i) {
    const Quad sum = MulAdd(QuadAt(columns.linear[i]), linear,
                            MulAdd(QuadAt(columns.angular[i]), angular, ZeroQuad()));
    out->torques[i] = query.bias[i] + moving[i] + SumOf(sum);
  }
}

void Leaf(const LeafQuery& query, LeafAnswer* out) {
  Columns columns, eliminated;
  MakeColumns(query.view, &columns);
  double velocity[7], wanted[7];
  LeafMotions(columns, query, velocity, wanted);
  alignas(32) Halves mobility;
  MobilityOf(query.view.n, query.mass, columns, &eliminated, mobility);
  double moving[kMaxChainJoints];
  MassTimesAny(query.view.n, query.mass, query.wanted, moving);
  Damp(*query.springs, mobility, velocity, wanted, out->damping, out->felt);
  TorquesOf(query, columns, moving, out);
}

void Mobility(const LeafView& view, const double* mass, double* mobility) {
  Columns columns, eliminated;
  MakeColumns(view, &columns);
  alignas(32) Halves halves;
  MobilityOf(view.n, mass, columns, &eliminated, halves);
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c <= r; ++c) mobility[Entry(r, c)] = At(halves, r, c);
  }
}

void DampAlone(const double* stiffness, const double* mobility, const double* velocity,
               double* out) {
  alignas(32) Halves halves;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c <= r; ++c) At(halves, r, c) = mobility[Entry(r, c)];
  }
  const double wanted[6] = {};
  double felt[6];
  Damp(MakeLeafSprings(stiffness), halves, velocity, wanted, out, felt);
}

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell {

HWY_EXPORT(Leaf);
HWY_EXPORT(Mobility);
HWY_EXPORT(DampAlone);

LeafSprings MakeLeafSprings(const double* stiffness) {
  LeafSprings springs;
  for (int k = 0; k < 6; ++k) {
    springs.stiffness[k] = stiffness[k];
    springs.root[k] = std::sqrt(stiffness[k]);
  }
  return springs;
}

void ComputeLeaf(const LeafQuery& query, LeafAnswer* out) {
  HWY_DYNAMIC_DISPATCH(Leaf)(query, out);
}
void ComputeMobility(const LeafView& view, const double* mass, double* mobility) {
  HWY_DYNAMIC_DISPATCH(Mobility)(view, mass, mobility);
}
void CriticalDamping(const double* stiffness, const double* mobility, const double* velocity,
                     double* out) {
  HWY_DYNAMIC_DISPATCH(DampAlone)(stiffness, mobility, velocity, out);
}

}  // namespace robocell
#endif
