#include "robocell/kinematics/ik_descent.h"

#include <algorithm>
#include <Eigen/Cholesky>

namespace robocell {
namespace {

// Damping = kDamping * |error|^2 + kLeastDamping: bold far away would overshoot, cautious near the
// target would crawl.
constexpr double kDamping = 0.01, kLeastDamping = 1e-7;
// No hinge turns farther in one step (rad): the linear model holds no longer.
constexpr double kLargestTurn = 1.2;
// A try that lowers the squared error by less than this factor in so many steps sits in a dead end.
constexpr double kProgress = 0.7;
constexpr int kPatience = 4;
// A far target pulls no stronger than one at this distance, in lengths of the chain.
constexpr double kFarthest = 2;
constexpr int kApproachSteps = 10;

}  // namespace

IkDescent::IkDescent(const ChainModel& chain, const Transform& target, const IkOptions& options)
    : chain_(chain), target_(target), options_(options), per_metre_(1 / chain.length) {}

void IkDescent::Evaluate(const double* q) {
  ComputeFrames(chain_, q, &frames_);
  const PoseError error = ErrorTo(target_, frames_.tip);
  position_error_ = error.linear.norm();
  rotation_error_ = error.angular.norm();
  const double far = position_error_ * per_metre_;
  const double weight = far > kFarthest ? kFarthest / position_error_ : per_metre_;
  error_.head<3>() = error.linear * weight;
  error_.tail<3>() = options_.position_only ? Eigen::Vector3d::Zero() : error.angular;
}

bool IkDescent::Arrived() const {
  // A little stricter than asked, so that the final judgement cannot differ by rounding.
  const double tolerance = options_.tolerance * 0.999;
  return position_error_ <= tolerance && (options_.position_only || rotation_error_ <= tolerance);
}

double IkDescent::cost() const {
  const double linear = position_error_ * per_metre_;
  const double angular = options_.position_only ? 0 : rotation_error_;
  return linear * linear + angular * angular;
}

void IkDescent::ComputeJacobian() {
  for (int i = 0; i < chain_.n; ++i) {
    const Eigen::Vector3d& axis = frames_.axis[i];
    if (chain_.joints[i].slide) {
      jacobian_.col(i) << axis * per_metre_, Eigen::Vector3d::Zero();
    } else {
      jacobian_.col(i) << axis.cross(frames_.tip.translation - frames_.origin[i]) * per_metre_,
          axis;
    }
    if (options_.position_only) jacobian_.col(i).tail<3>().setZero();
  }
}

bool IkDescent::TrySolve(const double* q, const double* spare,
                         std::array<bool, kMaxChainJoints>* active, double* step) const {
  Vector6 task = error_;
  Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
  a.diagonal().setConstant(kDamping * error_.squaredNorm() + kLeastDamping);
  for (int i = 0; i < chain_.n; ++i) {
    if (!(*active)[i]) continue;
    a.noalias() += jacobian_.col(i) * jacobian_.col(i).transpose();
    if (spare) task -= jacobian_.col(i) * spare[i];
  }
  const Vector6 y = a.llt().solve(task);
  bool free = true;
  for (int i = 0; i < chain_.n; ++i) {
    if (!(*active)[i]) continue;
    step[i] = jacobian_.col(i).dot(y) + (spare ? spare[i] : 0);
    const bool pressing = (step[i] < 0 && q[i] <= chain_.joints[i].lower) ||
                          (step[i] > 0 && q[i] >= chain_.joints[i].upper);
    if (!pressing) continue;
    (*active)[i] = free = false;
    step[i] = 0;
  }
  return free;
}

void IkDescent::Step(const double* spare, double* q) {
  ++iterations_;
  ComputeJacobian();
  std::array<bool, kMaxChainJoints> active;
  std::array<double, kMaxChainJoints> step{};
  for (int i = 0; i < chain_.n; ++i) active[i] = !options_.locked[i];
  while (!TrySolve(q, spare, &active, step.data())) {
  }
  double turn = 0;
  for (int i = 0; i < chain_.n; ++i) {
    if (!chain_.joints[i].slide) turn = std::max(turn, std::abs(step[i]));
  }
  const double scale = turn > kLargestTurn ? kLargestTurn / turn : 1;
  for (int i = 0; i < chain_.n; ++i) {
    if (options_.locked[i]) continue;
    q[i] = std::clamp(q[i] + scale * step[i], chain_.joints[i].lower, chain_.joints[i].upper);
  }
}

bool IkDescent::Run(double* q) {
  Evaluate(q);
  double before = cost();
  for (int k = 0; k < options_.max_iterations && !Arrived(); ++k) {
    if (k > 0 && k % kPatience == 0) {
      if (cost() > kProgress * before) return false;
      before = cost();
    }
    Step(nullptr, q);
    Evaluate(q);
  }
  return Arrived();
}

bool IkDescent::Approach(const double* goal, double* q) {
  std::array<double, kMaxChainJoints> spare{};
  Evaluate(q);
  for (int k = 0; k < kApproachSteps; ++k) {
    for (int i = 0; i < chain_.n; ++i) spare[i] = options_.locked[i] ? 0 : 0.5 * (goal[i] - q[i]);
    Step(spare.data(), q);
    Evaluate(q);
  }
  return Run(q);
}

}  // namespace robocell
