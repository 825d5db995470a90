#include "robocell/control/leaf_kernel.h"

#include <cmath>

#include "robocell/control/inverse_root.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/control/leaf_kernel.cc"
// As in link_kernel.cc.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/kinematics/lane_quad-inl.h"
#include "robocell/kinematics/lane_six-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One number in a register, so that products and sums are fused as in the lanes.
using One = hn::CappedTag<double, 1>;
constexpr One kOne;
using Poles = hn::CappedTag<double, 8>;
constexpr Poles kPoles;

// Solves for one right side; returns the determinant.
HWY_INLINE double SolveOne(const double* matrix, double* b) {
  hn::Vec<One> a[kEntries], x[6];
  for (int k = 0; k < kEntries; ++k) a[k] = hn::Set(kOne, matrix[k]);
  for (int k = 0; k < 6; ++k) x[k] = hn::Set(kOne, b[k]);
  const double determinant = hn::GetLane(SolveSix(kOne, a, x));
  for (int k = 0; k < 6; ++k) b[k] = hn::GetLane(x[k]);
  return determinant;
}

// The columns of a Jacobian.
struct Columns {
  alignas(64) double linear[kMaxChainJoints][4];
  alignas(64) double angular[kMaxChainJoints][4];
};

HWY_INLINE void MakeColumns(int n, const LinkTable::Row* rows, Columns* columns) {
  const auto zero = hn::Zero(kPoles);
  const auto at = [&](int row, int i) HWY_ATTR { return hn::Load(kPoles, rows[row] + i); };
  for (int i = 0; i < n; i += hn::Lanes(kPoles)) {
    hn::StoreInterleaved4(at(0, i), at(1, i), at(2, i), zero, kPoles, columns->linear[i]);
    hn::StoreInterleaved4(at(3, i), at(4, i), at(5, i), zero, kPoles, columns->angular[i]);
  }
}

// Jacobian * rates
HWY_INLINE void LeafMotion(int n, const Columns& columns, const double* rates, double* out) {
  Quad linear = Times(rates[0], QuadAt(columns.linear[0]));
  Quad angular = Times(rates[0], QuadAt(columns.angular[0]));
  for (int i = 1; i < n; ++i) {
    linear = MulAdd(rates[i], QuadAt(columns.linear[i]), linear);
    angular = MulAdd(rates[i], QuadAt(columns.angular[i]), angular);
  }
  alignas(32) double both[8];
  Put(linear, both);
  Put(angular, both + 4);
  for (int k = 0; k < 3; ++k) {
    out[k] = both[k];
    out[k + 3] = both[k + 4];
  }
}

// With mass = L D L^T: columns becomes (L^-1 J^T)^T. For a number of joints that is known here,
// all of it stays in registers.
template <int N>
HWY_INLINE void Eliminate(int joints, const LinkTable::Row* mass, Columns* columns,
                          double* inverse) {
  const int n = N ? N : joints;
  constexpr int kMost = N ? N : kMaxChainJoints;
  hn::Vec<One> m[kMost][kMost];
#pragma GCC unroll 7
  for (int i = 0; i < n; ++i) {
#pragma GCC unroll 7
    for (int k = 0; k <= i; ++k) m[i][k] = hn::Set(kOne, mass[i][k]);
  }
#pragma GCC unroll 7
  for (int k = 0; k < n; ++k) {
    const auto reciprocal = hn::Div(hn::Set(kOne, -1.0), m[k][k]);
    inverse[k] = -hn::GetLane(reciprocal);
    const Quad linear = QuadAt(columns->linear[k]), angular = QuadAt(columns->angular[k]);
#pragma GCC unroll 7
    for (int i = k + 1; i < n; ++i) {
      const auto factor = hn::Mul(m[i][k], reciprocal);
#pragma GCC unroll 7
      for (int j = k + 1; j <= i; ++j) m[i][j] = hn::MulAdd(factor, m[j][k], m[i][j]);
      const double f = hn::GetLane(factor);
      Put(MulAdd(f, linear, QuadAt(columns->linear[i])), columns->linear[i]);
      Put(MulAdd(f, angular, QuadAt(columns->angular[i])), columns->angular[i]);
    }
  }
}

HWY_INLINE void MobilityOf(int n, const LinkTable::Row* mass, Columns* columns, double* mobility) {
  double inverse[kMaxChainJoints];
  switch (n) {
    case 6:
      Eliminate<6>(n, mass, columns, inverse);
      break;
    case 7:
      Eliminate<7>(n, mass, columns, inverse);
      break;
    default:
      Eliminate<0>(n, mass, columns, inverse);
  }
  // Rows, the left and the right half; upper right ones are not needed.
  Quad left[6], right[6];
  for (int r = 0; r < 6; ++r) left[r] = right[r] = ZeroQuad();
  for (int k = 0; k < n; ++k) {
    const Quad linear = QuadAt(columns->linear[k]), angular = QuadAt(columns->angular[k]);
#pragma GCC unroll 3
    for (int r = 0; r < 3; ++r) {
      const double up = columns->linear[k][r] * inverse[k];
      const double down = columns->angular[k][r] * inverse[k];
      left[r] = MulAdd(up, linear, left[r]);
      left[r + 3] = MulAdd(down, linear, left[r + 3]);
      right[r + 3] = MulAdd(down, angular, right[r + 3]);
    }
  }
  alignas(32) double row[8];
  for (int r = 0; r < 6; ++r) {
    Put(left[r], row);
    Put(right[r], row + 4);
    for (int c = 0; c <= r; ++c) mobility[Entry(r, c)] = row[c < 3 ? c : c + 1];
    mobility[Entry(r, r)] += kLeastMobility;
  }
}

HWY_INLINE const InverseRoot& RootFor(double range) {
  const InverseRoot* roots = InverseRoots();
  for (int k = 0; k < kInverseRoots - 1; ++k) {
    if (range <= roots[k].range) return roots[k];
  }
  return roots[kInverseRoots - 1];
}

// `determinant` is that of the mobility.
HWY_INLINE void Damp(const double* stiffness, const double* mobility, double determinant,
                     const double* velocity, double* out) {
  double root[6], trace = 0, softest = HUGE_VAL;
  for (int k = 0; k < 6; ++k) {
    root[k] = std::sqrt(stiffness[k]);
    if (stiffness[k] > 0 && stiffness[k] < softest) softest = stiffness[k];
    trace += stiffness[k] * mobility[Entry(k, k)];
    determinant *= stiffness[k];
    out[k] = 0;
  }
  if (trace == 0) return;
  double scaled[kEntries], along[6];
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c <= r; ++c) scaled[Entry(r, c)] = root[r] * root[c] * mobility[Entry(r, c)];
    along[r] = root[r] * velocity[r];
  }
  // No eigenvalue is less than that of the softest spring on the heaviest leaf, nor than what the
  // others, as large as they can be together, leave of the determinant.
  const double share = 5 / trace, share2 = share * share;
  const double by_determinant = determinant * share2 * share2 * share;
  const double by_bound = kLeastMobility * softest;
  const InverseRoot& poles =
      RootFor(trace / (by_determinant > by_bound ? by_determinant : by_bound));

  using V = hn::Vec<Poles>;
  V sums[6];
  for (V& sum : sums) sum = hn::Zero(kPoles);
  for (int first = 0; first < poles.n_poles; first += hn::Lanes(kPoles)) {
    V a[kEntries], b[6];
    for (int k = 0; k < kEntries; ++k) a[k] = hn::Set(kPoles, scaled[k]);
    const V shift = hn::Mul(hn::Set(kPoles, trace), hn::Load(kPoles, poles.shift + first));
    for (int k = 0; k < 6; ++k) {
      a[Entry(k, k)] = hn::Add(a[Entry(k, k)], shift);
      b[k] = hn::Set(kPoles, along[k]);
    }
    SolveSix(kPoles, a, b);
    const V weight = hn::Load(kPoles, poles.weight + first);
    for (int k = 0; k < 6; ++k) sums[k] = hn::MulAdd(weight, b[k], sums[k]);
  }
  const double scale = 2 * std::sqrt(trace);
  for (int k = 0; k < 6; ++k)
    out[k] = scale * root[k] * hn::GetLane(hn::SumOfLanes(kPoles, sums[k]));
}

HWY_INLINE void TorquesOf(const LeafQuery& query, LeafAnswer* out) {
  hn::Vec<Poles> force[6];
  for (int k = 0; k < 6; ++k) {
    // What the joints to spare do is not to be felt.
    force[k] = hn::Set(kPoles, query.stiffness[k] * query.deviation[k] -
                                   query.damping_ratio * out->damping[k] + query.feedforward[k] -
                                   out->felt[k]);
  }
  for (int i = 0; i < query.n; i += hn::Lanes(kPoles)) {
    auto sum = hn::Load(kPoles, query.torques + i);
    for (int k = 0; k < 6; ++k)
      sum = hn::MulAdd(force[k], hn::Load(kPoles, query.jacobian[k] + i), sum);
    hn::Store(sum, kPoles, out->torques + i);
  }
}

void Leaf(const LeafQuery& query, LeafAnswer* out) {
  Columns columns;
  MakeColumns(query.n, query.jacobian, &columns);
  double velocity[6], mobility[kEntries];
  LeafMotion(query.n, columns, query.velocity, velocity);
  LeafMotion(query.n, columns, query.wanted, out->felt);
  MobilityOf(query.n, query.mass, &columns, mobility);
  const double determinant = SolveOne(mobility, out->felt);
  Damp(query.stiffness, mobility, determinant, velocity, out->damping);
  TorquesOf(query, out);
}

void Mobility(int n, const LinkTable::Row* jacobian, const LinkTable::Row* mass, double* mobility) {
  Columns columns;
  MakeColumns(n, jacobian, &columns);
  MobilityOf(n, mass, &columns, mobility);
}

void DampAlone(const double* stiffness, const double* mobility, const double* velocity,
               double* out) {
  double nothing[6] = {};
  Damp(stiffness, mobility, SolveOne(mobility, nothing), velocity, out);
}

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell {

HWY_EXPORT(Leaf);
HWY_EXPORT(Mobility);
HWY_EXPORT(DampAlone);

void ComputeLeaf(const LeafQuery& query, LeafAnswer* out) {
  HWY_DYNAMIC_DISPATCH(Leaf)(query, out);
}
void ComputeMobility(int n, const LinkTable::Row* jacobian, const LinkTable::Row* mass,
                     double* mobility) {
  HWY_DYNAMIC_DISPATCH(Mobility)(n, jacobian, mass, mobility);
}
void CriticalDamping(const double* stiffness, const double* mobility, const double* velocity,
                     double* out) {
  HWY_DYNAMIC_DISPATCH(DampAlone)(stiffness, mobility, velocity, out);
}

}  // namespace robocell
#endif
