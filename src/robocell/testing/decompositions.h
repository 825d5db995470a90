// Decompositions of matrices for tests. Eigen's are templates that cost seconds in each file that
// uses them; here they are compiled once.
#pragma once

#include <Eigen/Core>

namespace robocell {

struct Svd {
  Eigen::VectorXd values;  // the greatest first
  Eigen::MatrixXd left;    // square; column i belongs to value i
};
Svd SvdOf(const Eigen::MatrixXd& m);

struct Eigenpairs {
  Eigen::VectorXd values;   // the least first
  Eigen::MatrixXd vectors;  // in columns, orthonormal
};
// Of a symmetric matrix.
Eigenpairs EigenpairsOf(const Eigen::MatrixXd& m);

// Unit vectors, in columns, that `m` takes to zero.
Eigen::MatrixXd NullSpaceOf(const Eigen::MatrixXd& m);

// The orthogonal factor of a square matrix (QR).
Eigen::MatrixXd OrthogonalPartOf(const Eigen::MatrixXd& m);

// x with m x = right side, for a symmetric positive definite m.
Eigen::MatrixXd SolvePositive(const Eigen::MatrixXd& m, const Eigen::MatrixXd& right_side);

}  // namespace robocell
