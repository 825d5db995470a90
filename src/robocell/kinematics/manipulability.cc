#include "robocell/kinematics/manipulability.h"

#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>

namespace robocell {
namespace {

using Jacobian6 = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxChainJoints>;
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Smallest divisor, as a share of the largest entry: keeps it away from 0.
constexpr double kLeastPart = 1e-12;

// Computes the Jacobian at the tip, linear rows first. A slide's axis is in `frames`, its lower
// rows are 0.
Jacobian6 JacobianAt(const ChainModel& chain, const ChainFrames& frames) {
  Jacobian6 j(6, chain.n);
  for (int i = 0; i < chain.n; ++i) {
    const Eigen::Vector3d& axis = frames.axis[i];
    if (chain.joints[i].slide) {
      j.col(i) << axis, Eigen::Vector3d::Zero();
    } else {
      j.col(i) << axis.cross(frames.tip.translation - frames.origin[i]), axis;
    }
  }
  return j;
}

// Returns the transposed pseudoinverse: column i belongs to column i of the Jacobian.
Jacobian6 TransposedInverse(const Jacobian6& j) {
  if (j.cols() >= 6) {
    Matrix6 squared = j * j.transpose();
    squared.diagonal().array() += kLeastPart * squared.diagonal().maxCoeff();
    return squared.llt().solve(j);
  }
  Small squared = j.transpose() * j;
  squared.diagonal().array() += kLeastPart * squared.diagonal().maxCoeff();
  return squared.llt().solve(j.transpose()).transpose();
}

// Requires a symmetric matrix without negative eigenvalues.
template <class Matrix>
double RootOfDeterminant(const Matrix& m) {
  const Eigen::LDLT<Matrix> factors(m);
  double product = 1;
  for (Eigen::Index i = 0; i < m.rows(); ++i) product *= std::max(factors.vectorD()[i], 0.0);
  return std::sqrt(product);
}

}  // namespace

double ManipulabilityOf(const ChainModel& chain, const double* q) {
  ChainFrames frames;
  ComputeFrames(chain, q, &frames);
  const Jacobian6 j = JacobianAt(chain, frames);
  if (chain.n >= 6) return RootOfDeterminant(Matrix6(j * j.transpose()));
  return RootOfDeterminant(Small(j.transpose() * j));
}

// d log w = trace(J^+ dJ), and dJ consists of cross products: a hinge turns the columns of the
// joints behind it, columns of the joints before it only follow the tip.
void LogManipulabilityGradient(const ChainModel& chain, const double* q, double* gradient) {
  ChainFrames frames;
  ComputeFrames(chain, q, &frames);
  const Jacobian6 j = JacobianAt(chain, frames);
  const Jacobian6 inverse = TransposedInverse(j);
  Eigen::Vector3d before = Eigen::Vector3d::Zero(), carried = Eigen::Vector3d::Zero();
  for (int k = 0; k < chain.n; ++k) {
    gradient[k] = j.col(k).head<3>().dot(before);
    if (!chain.joints[k].slide) before += inverse.col(k).head<3>().cross(frames.axis[k]);
  }
  for (int k = chain.n - 1; k >= 0; --k) {
    carried += j.col(k).head<3>().cross(inverse.col(k).head<3>()) +
               j.col(k).tail<3>().cross(inverse.col(k).tail<3>());
    if (!chain.joints[k].slide) gradient[k] += frames.axis[k].dot(carried);
  }
}

double Manipulability(const Chain& chain, std::span<const double> q) {
  chain.RequireJointValues("manipulability: q", q);
  return ManipulabilityOf(chain.model(), q.data());
}

}  // namespace robocell
