#include "robocell/motion/path_judge.h"

#include <algorithm>
#include <cmath>
#include <Eigen/LU>

namespace robocell::internal {
namespace {

// Returns k with the lowest `bits` bits in reverse: blocks of an edge are checked far apart first.
unsigned Reversed(unsigned k, unsigned bits) {
  unsigned r = 0;
  for (unsigned i = 0; i < bits; ++i) r |= ((k >> i) & 1u) << (bits - 1 - i);
  return r;
}

constexpr int kProjections = 30;
constexpr double kMostTurnAtOnce = 0.3;  // rad of the error in one projection

}  // namespace

JointVector TipAxis::ChainValues(std::span<const double> q) const {
  JointVector values = present;
  for (size_t i = 0; i < dofs.size(); ++i) {
    if (dofs[i] >= 0) values[static_cast<int>(i)] = q[dofs[i]];
  }
  return values;
}

double TipAxis::Angle(std::span<const double> q) const {
  const Eigen::Vector3d now = chain.Fk(ChainValues(q)).rotation() * in_tip;
  return std::atan2(now.cross(in_base).norm(), now.dot(in_base));
}

bool TipAxis::Project(const std::vector<Interval>& limits, std::span<double> q) const {
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, chain.n_joints());
  // Somewhat inside, so that rounding and the way between two configurations leave it there.
  const double within = 0.9 * tolerance;
  for (int k = 0; k < kProjections; ++k) {
    const Pose tip = chain.Jacobian(ChainValues(q), jacobian);
    const Eigen::Vector3d now = tip.rotation() * in_tip;
    Eigen::Vector3d about = now.cross(in_base);
    const double sine = about.norm(), angle = std::atan2(sine, now.dot(in_base));
    if (angle <= tolerance) return true;
    if (sine < 1e-6) return false;  // opposite: any axis would do
    about *= std::min(angle - within, kMostTurnAtOnce) / sine;
    // Least squares with damping: dq = J^T (J J^T + c)^-1 about.
    const auto angular = jacobian.bottomRows<3>();
    Eigen::Matrix3d square = angular * angular.transpose();
    square.diagonal().array() += 1e-4;
    const Eigen::VectorXd dq = angular.transpose() * (square.inverse() * about);
    for (size_t i = 0; i < dofs.size(); ++i) {
      if (dofs[i] < 0) continue;
      const Interval& limit = limits[dofs[i]];
      double& value = q[dofs[i]];
      value = std::clamp(value + dq[static_cast<Eigen::Index>(i)], limit.lower, limit.upper);
    }
  }
  return Angle(q) <= tolerance;
}

void PathJudge::Use(Kind kind, double step, double more) {
  kind_ = kind;
  step_ = step;
  more_ = more;
}

bool PathJudge::AreFree(int count) {
  if (kind_ == Kind::kEngine) return model_.Hit(rows_, count, true, more_) == 0;
  return model_.MayHit(rows_, count, SphereJudge::kBold, true, more_) == 0;
}

bool PathJudge::IsFree(std::span<const double> q) {
  if (axis_ && axis_->Angle(q) > axis_->tolerance) return false;
  rows_.assign(q.begin(), q.end());
  return AreFree(1);
}

bool PathJudge::Project(std::span<double> q) { return !axis_ || axis_->Project(limits_, q); }

bool PathJudge::IsFree(std::span<const double> a, std::span<const double> b) {
  const size_t n = a.size();
  double longest = 0;
  for (size_t i = 0; i < n; ++i)
    longest = std::max(longest, std::abs(b[i] - a[i]) / space_.units[i]);
  const int steps = std::max(1, static_cast<int>(std::ceil(longest / step_ - 1e-9)));
  // Lanes are spread over the whole edge: configuration k is in block k % blocks.
  const int blocks = (steps + kLanes - 1) / kLanes;
  unsigned bits = 0;
  while ((1u << bits) < static_cast<unsigned>(blocks)) ++bits;
  rows_.resize(kLanes * n);
  std::vector<double> at(axis_ ? n : 0);
  for (unsigned i = 0; i < (1u << bits); ++i) {
    const int block = static_cast<int>(Reversed(i, bits));
    if (block >= blocks) continue;
    int count = 0;
    for (int k = block; k < steps; k += blocks) {
      const double part = static_cast<double>(steps - k) / steps;  // the end first
      double* row = rows_.data() + static_cast<size_t>(count++) * n;
      for (size_t j = 0; j < n; ++j) row[j] = part == 1 ? b[j] : a[j] + part * (b[j] - a[j]);
      if (axis_ && axis_->Angle({row, n}) > axis_->tolerance) return false;
    }
    if (!AreFree(count)) return false;
  }
  return true;
}

}  // namespace robocell::internal
