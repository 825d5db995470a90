// The inverse root of a symmetric positive matrix, applied to a vector, without eigenvectors:
//
//   A^(-1/2) v  =  sum over the poles of  sqrt(top) weight (A + top shift)^-1 v
//
// for a matrix whose eigenvalues lie between top / range and top. The sum is a positive symmetric
// matrix with the same eigenvectors, within 1e-4 of the exact one (N. Hale, N. J. Higham, L. N.
// Trefethen, "Computing A^alpha, log(A), and related matrix functions by contour integrals", 2008,
// method 3). Eigenvalues below the range are underestimated.
//
// Plain numbers only; this header is included by code for every instruction set.
#pragma once

namespace robocell::internal {

struct InverseRoot {
  static constexpr int kMostPoles = 24;

  int n_poles = 0;  // padded with weights of 0 to a multiple of 8
  double range = 0;
  alignas(64) double shift[kMostPoles] = {};
  alignas(64) double weight[kMostPoles] = {};
};

// The sums for increasing ranges; the last one is used for all larger ranges. The first one has
// seven poles, and a shift of 0 in place of the eighth.
inline constexpr int kInverseRoots = 3;
const InverseRoot* InverseRoots();

}  // namespace robocell::internal
