#include "robocell/testing/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace robocell {

using Eigen::MatrixXd;

Svd SvdOf(const MatrixXd& m) {
  const Eigen::JacobiSVD<MatrixXd> svd(m, Eigen::ComputeFullU);
  return {svd.singularValues(), svd.matrixU()};
}

Eigenpairs EigenpairsOf(const MatrixXd& m) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(m);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

MatrixXd NullSpaceOf(const MatrixXd& m) {
  return Eigen::FullPivLU<MatrixXd>(m).kernel().colwise().normalized();
}

MatrixXd OrthogonalPartOf(const MatrixXd& m) { return m.householderQr().householderQ(); }

MatrixXd SolvePositive(const MatrixXd& m, const MatrixXd& right_side) {
  return m.llt().solve(right_side);
}

}  // namespace robocell
