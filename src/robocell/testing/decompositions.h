// Decompositions of matrices for tests. Eigen's are templates that cost seconds in each file that
// uses them; here they are compiled once.
#pragma once

#include <Eigen/Core>

namespace robocell {

struct Svd {
  Eigen::VectorXd values;  // in descending order
  Eigen::MatrixXd left;    // square; column i belongs to value i
};
Svd SvdOf(const Eigen::MatrixXd& m);

struct Eigenpairs {
  Eigen::VectorXd values;   // in ascending order
  Eigen::MatrixXd vectors;  // in columns, orthonormal
};
// Decomposes a symmetric matrix.
Eigenpairs EigenpairsOf(const Eigen::MatrixXd& m);

// Returns unit vectors, in columns, that `m` maps to zero.
Eigen::MatrixXd NullSpaceOf(const Eigen::MatrixXd& m);

// Returns the orthogonal factor of a square matrix (QR).
Eigen::MatrixXd OrthogonalPartOf(const Eigen::MatrixXd& m);

// Returns x with m x = right side, for a symmetric positive definite m.
Eigen::MatrixXd SolvePositive(const Eigen::MatrixXd& m, const Eigen::MatrixXd& right_side);

}  // namespace robocell
