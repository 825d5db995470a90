#include "robocell/kinematics/manipulability.h"

#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>

namespace robocell {
namespace {

// Of a symmetric matrix without negative eigenvalues.
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
  Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxChainJoints> j(6, chain.n);
  for (int i = 0; i < chain.n; ++i) {
    const Eigen::Vector3d& axis = frames.axis[i];
    if (chain.joints[i].slide) {
      j.col(i) << axis, Eigen::Vector3d::Zero();
    } else {
      j.col(i) << axis.cross(frames.tip.translation - frames.origin[i]), axis;
    }
  }
  if (chain.n >= 6) return RootOfDeterminant(Eigen::Matrix<double, 6, 6>(j * j.transpose()));
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
  return RootOfDeterminant(Small(j.transpose() * j));
}

double Manipulability(const Chain& chain, std::span<const double> q) {
  chain.CheckJointValues("manipulability: q", q);
  return ManipulabilityOf(chain.model(), q.data());
}

}  // namespace robocell
