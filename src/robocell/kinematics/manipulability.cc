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

// Returns the columns of the degrees of freedom, from those of all joints.
Jacobian6 Reduced(const CoupledLinks& coupled, const double* slopes, const Jacobian6& all) {
  Jacobian6 j = Jacobian6::Zero(6, coupled.n);
  for (int i = 0; i < coupled.links.n; ++i) j.col(coupled.leader[i]) += slopes[i] * all.col(i);
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

// d log w = trace(J^+ dJ), and dJ consists of cross products: a hinge turns the columns of the
// joints behind it, columns of the joints before it only follow the tip. `links` are all joints.
void GradientOfLinks(const ChainModel& links, const ChainFrames& frames, const Jacobian6& j,
                     const Jacobian6& inverse, double* gradient) {
  Eigen::Vector3d before = Eigen::Vector3d::Zero(), carried = Eigen::Vector3d::Zero();
  for (int k = 0; k < links.n; ++k) {
    gradient[k] = j.col(k).head<3>().dot(before);
    if (!links.joints[k].slide) before += inverse.col(k).head<3>().cross(frames.axis[k]);
  }
  for (int k = links.n - 1; k >= 0; --k) {
    carried += j.col(k).head<3>().cross(inverse.col(k).head<3>()) +
               j.col(k).tail<3>().cross(inverse.col(k).tail<3>());
    if (!links.joints[k].slide) gradient[k] += frames.axis[k].dot(carried);
  }
}

// The Jacobian of the degrees of freedom is J D, where D has the slopes: its change is dJ D + J dD.
void GradientOfCoupled(const CoupledLinks& coupled, const double* x, const ChainFrames& frames,
                       const Jacobian6& j, double* gradient) {
  std::array<double, kMaxChainJoints> slopes, of_links;
  coupled.Slopes(x, slopes.data());
  const Jacobian6 inverse = TransposedInverse(Reduced(coupled, slopes.data(), j));
  Jacobian6 of_joints(6, coupled.links.n);
  for (int i = 0; i < coupled.links.n; ++i)
    of_joints.col(i) = slopes[i] * inverse.col(coupled.leader[i]);
  GradientOfLinks(coupled.links, frames, j, of_joints, of_links.data());
  std::fill_n(gradient, coupled.n, 0.0);
  for (int i = 0; i < coupled.links.n; ++i) {
    const int l = coupled.leader[i];
    gradient[l] += slopes[i] * of_links[i] +
                   coupled.polynomial[i].curvature(x[l]) * j.col(i).dot(inverse.col(l));
  }
}

}  // namespace

double ManipulabilityOf(const ChainModel& chain, const double* q) {
  ChainFrames frames;
  ComputeFrames(chain, q, &frames);
  Jacobian6 j = JacobianAt(LinksOf(chain), frames);
  if (chain.coupled) {
    std::array<double, kMaxChainJoints> slopes;
    chain.coupled->Slopes(q, slopes.data());
    j = Reduced(*chain.coupled, slopes.data(), j);
  }
  if (chain.n >= 6) return RootOfDeterminant(Matrix6(j * j.transpose()));
  return RootOfDeterminant(Small(j.transpose() * j));
}

void LogManipulabilityGradient(const ChainModel& chain, const double* q, double* gradient) {
  ChainFrames frames;
  ComputeFrames(chain, q, &frames);
  const Jacobian6 j = JacobianAt(LinksOf(chain), frames);
  if (chain.coupled) return GradientOfCoupled(*chain.coupled, q, frames, j, gradient);
  GradientOfLinks(chain, frames, j, TransposedInverse(j), gradient);
}

double Manipulability(const Chain& chain, std::span<const double> q) {
  chain.RequireJointValues("manipulability: q", q);
  return ManipulabilityOf(chain.model(), q.data());
}

}  // namespace robocell
