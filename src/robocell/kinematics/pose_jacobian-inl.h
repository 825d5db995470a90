// Tips, Jacobians and manipulabilities of one configuration per lane. Included once for each
// instruction set, after pose_steps-inl.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE Vec3<P> TipPosition(const PoseTable& t, const Frame3<P>& last) {
  return Add(last.p, Turned(last, All(t.tip_translation)));
}

HWY_INLINE void WriteTips(const PoseTable& t, const Frame3<P>& last, const Vec3<P>& position,
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

template <class Chain>
HWY_NOINLINE void TipsOf(const Chain& chain, const JointMoves& moves, double* out) {
  const Frame3<P> last = WalkPoses(chain, moves, [](int, const Frame3<P>&) POSE_INLINE {});
  WriteTips(chain.t, last, TipPosition(chain.t, last), out);
}

// Calls visit(i, column of the Jacobian at the tip) for each joint; writes tips if requested.
template <class Chain, class Visit>
HWY_INLINE void VisitColumns(const Chain& chain, const JointMoves& moves, double* tips,
                             Visit&& visit) {
  JointVectors axis, point;
  const Frame3<P> last = WalkPoses(chain, moves, [&](int i, const Frame3<P>& f) POSE_INLINE {
    axis.Put(i, f.z);
    point.Put(i, f.p);
  });
  const Vec3<P> tip = TipPosition(chain.t, last);
  chain.Up(0, chain.n() - 1, [&](int i) POSE_INLINE {
    const Vec3<P> along = axis[i];
    if (chain[i].slide()) {
      visit(i, Six<P>{along, ZeroVector()});
    } else {
      visit(i, Six<P>{Cross(along, Sub(tip, point[i])), along});
    }
  });
  if (tips) WriteTips(chain.t, last, tip, tips);
}

template <class Chain>
HWY_NOINLINE void JacobiansOf(const Chain& chain, const JointMoves& moves, double* out,
                              double* tips) {
  Outputs<6 * kMaxChainJoints> jacobian;
  const int n = chain.n();
  VisitColumns(chain, moves, tips, [&](int i, const Six<P>& column) POSE_INLINE {
    jacobian.Put(i, column.linear.x);
    jacobian.Put(n + i, column.linear.y);
    jacobian.Put(2 * n + i, column.linear.z);
    jacobian.Put(3 * n + i, column.angular.x);
    jacobian.Put(4 * n + i, column.angular.y);
    jacobian.Put(5 * n + i, column.angular.z);
  });
  jacobian.Write(6 * n, out);
}

// Least pivot, relative to the largest on the diagonal.
constexpr double kLeastPivot = 1e-20;

// Computes the lower triangle of the smaller of J J^T and J^T J; returns its number of rows.
HWY_INLINE int SquaredOf(const JointNumbers<6>& columns, int n, P (*square)[6]) {
  const int rows = HWY_MIN(n, 6);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c <= r; ++c) {
      P sum = hn::Zero(kPoses);
      for (int k = 0, end = HWY_MAX(n, 6); k < end; ++k) {
        sum = n < 6 ? hn::MulAdd(columns.Get(r, k), columns.Get(c, k), sum)
                    : hn::MulAdd(columns.Get(k, r), columns.Get(k, c), sum);
      }
      square[r][c] = sum;
    }
  }
  return rows;
}

// Returns the root of the determinant of a symmetric matrix without negative eigenvalues, which it
// overwrites.
HWY_INLINE P RootOfDeterminant(P (*a)[6], int rows) {
  P largest = hn::Zero(kPoses), product = All(1);
  for (int k = 0; k < rows; ++k) largest = hn::Max(largest, a[k][k]);
  // The smallest divisor; for a smaller pivot the product is negligible anyway.
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

template <class Chain>
HWY_NOINLINE void ManipulabilitiesOf(const Chain& chain, const JointMoves& moves, double* out) {
  JointNumbers<6> columns;
  VisitColumns(chain, moves, nullptr, [&](int i, const Six<P>& c) POSE_INLINE {
    columns.Put(i, 0, c.linear.x);
    columns.Put(i, 1, c.linear.y);
    columns.Put(i, 2, c.linear.z);
    columns.Put(i, 3, c.angular.x);
    columns.Put(i, 4, c.angular.y);
    columns.Put(i, 5, c.angular.z);
  });
  P square[6][6];
  const int rows = SquaredOf(columns, chain.n(), square);
  Outputs<1> values;
  values.Put(0, RootOfDeterminant(square, rows));
  values.Write(1, out);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
