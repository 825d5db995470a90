// Solves six equations in six unknowns in all lanes. Included once for each instruction set.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Index of an entry of a symmetric 6 x 6 matrix whose lower triangle is stored row by row.
HWY_INLINE constexpr int Entry(int row, int column) { return row * (row + 1) / 2 + column; }
constexpr int kEntries = 21;

// Solves for b in place by L D L^T; `one` is full of ones. Returns the product of D, the
// determinant.
template <class V>
HWY_INLINE V SolveSix(V one, V* a, V* b) {
  V inverse[6], factor[6];
  V determinant = one;
#pragma GCC unroll 6
  for (int j = 0; j < 6; ++j) {
    determinant = Mul(determinant, a[Entry(j, j)]);
    // The inverses of two entries of D are computed together, from the minor of both, so that the
    // two divisions wait as one.
    if (j % 2 == 0) {
      const V first = a[Entry(j, j)], between = a[Entry(j + 1, j)];
      const V minor = MulSub(first, a[Entry(j + 1, j + 1)], Mul(between, between));
      inverse[j] = Div(one, first);
      inverse[j + 1] = Mul(first, Div(one, minor));
    }
#pragma GCC unroll 6
    for (int i = j + 1; i < 6; ++i) {
      factor[i] = Mul(a[Entry(i, j)], inverse[j]);
#pragma GCC unroll 6
      for (int k = j + 1; k <= i; ++k)
        a[Entry(i, k)] = NegMulAdd(factor[i], a[Entry(k, j)], a[Entry(i, k)]);
      b[i] = NegMulAdd(factor[i], b[j], b[i]);
    }
#pragma GCC unroll 6
    for (int i = j + 1; i < 6; ++i) a[Entry(i, j)] = factor[i];  // of L
  }
#pragma GCC unroll 6
  for (int j = 5; j >= 0; --j) {
    b[j] = Mul(b[j], inverse[j]);
    // The value that is known last comes last, because a single query waits for every sum.
#pragma GCC unroll 6
    for (int i = 5; i > j; --i) b[j] = NegMulAdd(a[Entry(i, j)], b[i], b[j]);
  }
  return determinant;
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
