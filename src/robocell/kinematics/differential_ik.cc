#include "robocell/kinematics/differential_ik.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "robocell/base/error.h"
#include "robocell/kinematics/chain_model.h"
#include "robocell/math/rotation.h"

namespace robocell {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Jacobian6 = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxChainJoints>;

// Squared; lengths in units of the chain's.
constexpr double kLeastDamping = 1e-8, kMostDamping = 4e-4;
// Singular values of the Jacobian below this are near a singularity.
constexpr double kNearSingular = 0.02;
// Rounds that recompute the damping for the joints that were not at their bounds; after them it
// only grows.
constexpr int kRoundsAtWill = 4;
// A tip counts as slower than requested from this share of the twist on, and from these rad/s or
// lengths per second.
constexpr double kNoticed = 1e-3, kStill = 1e-5;

enum class Side : char { kFree, kLower, kUpper };

// Least squares between bounds: every joint is free or at one of its bounds.
class BoundedLeastSquares {
 public:
  BoundedLeastSquares(const Jacobian6& jacobian, const Vector6& task)
      : n_(static_cast<int>(jacobian.cols())), jacobian_(jacobian), task_(task) {}

  std::array<double, kMaxChainJoints> lower{}, upper{}, preferred{};

  bool may_move(int i) const { return lower[i] < upper[i]; }
  // Returns true, after Solve, if the joint is not at a bound.
  bool is_free(int i) const { return side_[i] == Side::kFree; }

  void Solve(const Matrix6& damping, double* v) {
    damping_ = damping;
    for (int i = 0; i < n_; ++i) {
      v[i] = std::clamp(preferred[i], lower[i], upper[i]);
      side_[i] = may_move(i) ? Side::kFree : Side::kLower;
    }
    // Each round lowers the cost; only rounding could require more rounds.
    for (int round = 0; round < 8 * n_; ++round) {
      SolveFree(v);
      if (MoveAsFarAsAllowed(v) && !LetOneGo(v)) return;
    }
  }

 private:
  // Computes the best values of the free joints and keeps the others.
  void SolveFree(const double* v) {
    Matrix6 a = damping_;
    Vector6 left = task_;
    for (int i = 0; i < n_; ++i) {
      const bool free = side_[i] == Side::kFree;
      if (free) a.noalias() += jacobian_.col(i) * jacobian_.col(i).transpose();
      left -= jacobian_.col(i) * (free ? preferred[i] : v[i]);
    }
    pull_ = a.llt().solve(left);
    for (int i = 0; i < n_; ++i) {
      if (side_[i] == Side::kFree) best_[i] = preferred[i] + jacobian_.col(i).dot(pull_);
    }
  }

  // Moves towards the best values until the first joint is at a bound. Returns true if no bound was
  // in the way.
  bool MoveAsFarAsAllowed(double* v) {
    double share = 1;
    int stopped = -1;
    for (int i = 0; i < n_; ++i) {
      if (side_[i] != Side::kFree || (best_[i] >= lower[i] && best_[i] <= upper[i])) continue;
      const double bound = best_[i] < lower[i] ? lower[i] : upper[i];
      const double part = (bound - v[i]) / (best_[i] - v[i]);
      if (part >= share) continue;
      share = std::max(part, 0.0);
      stopped = i;
    }
    for (int i = 0; i < n_; ++i) {
      if (side_[i] == Side::kFree)
        v[i] = std::clamp(v[i] + share * (best_[i] - v[i]), lower[i], upper[i]);
    }
    if (stopped < 0) return true;
    side_[stopped] = best_[stopped] < lower[stopped] ? Side::kLower : Side::kUpper;
    v[stopped] = side_[stopped] == Side::kLower ? lower[stopped] : upper[stopped];
    return false;
  }

  // Frees the joint with the strongest pull away from its bound. Returns false if there is none: v
  // is the best.
  bool LetOneGo(const double* v) {
    double hardest = 1e-9 * pull_.norm() + 1e-12;
    int which = -1;
    for (int i = 0; i < n_; ++i) {
      if (side_[i] == Side::kFree || lower[i] >= upper[i]) continue;
      const double up = jacobian_.col(i).dot(pull_) + preferred[i] - v[i];
      const double away = side_[i] == Side::kLower ? up : -up;
      if (away <= hardest) continue;
      hardest = away;
      which = i;
    }
    if (which < 0) return false;
    side_[which] = Side::kFree;
    return true;
  }

  int n_;
  const Jacobian6& jacobian_;
  const Vector6& task_;
  Matrix6 damping_;
  // The best values of the free joints satisfy this: D^-1 times the residual of the task.
  Vector6 pull_;
  std::array<Side, kMaxChainJoints> side_{};
  std::array<double, kMaxChainJoints> best_{};
};

using Joints = std::array<bool, kMaxChainJoints>;

// Along each direction it grows from the least to the most as the singular value of the counting
// joints goes to 0.
Matrix6 DampingAt(const Jacobian6& jacobian, const Joints& count) {
  Matrix6 squared = Matrix6::Zero(), damping = kLeastDamping * Matrix6::Identity();
  for (Eigen::Index i = 0; i < jacobian.cols(); ++i) {
    if (count[i]) squared.noalias() += jacobian.col(i) * jacobian.col(i).transpose();
  }
  constexpr double kNear2 = kNearSingular * kNearSingular;
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(squared);
  for (int k = 0; k < 6 && eigen.eigenvalues()[k] < kNear2; ++k) {
    const double near = 1 - std::max(eigen.eigenvalues()[k], 0.0) / kNear2;
    const Vector6 along = eigen.eigenvectors().col(k);
    damping.noalias() += kMostDamping * near * near * along * along.transpose();
  }
  return damping;
}

// The joints at their bounds determine the damping, and the damping determines these joints.
void SolveDamped(const Jacobian6& jacobian, BoundedLeastSquares* squares, double* v) {
  const int n = static_cast<int>(jacobian.cols());
  Joints count{};
  for (int i = 0; i < n; ++i) count[i] = squares->may_move(i);
  for (int round = 0;; ++round) {
    squares->Solve(DampingAt(jacobian, count), v);
    Joints free{};
    for (int i = 0; i < n; ++i)
      free[i] = squares->is_free(i) && (round < kRoundsAtWill || count[i]);
    if (free == count) return;
    count = free;
  }
}

void RequireBase(const Eigen::Matrix3d& base_in_world) {
  try {
    QuaternionFromMatrix(base_in_world);
  } catch (const ArgumentError& error) {
    throw ArgumentError(
        fmt::format("differential inverse kinematics: base_in_world: {}", error.what()));
  }
}

void RequireDifferentialIk(const Chain& chain, const Twist& twist,
                           const DifferentialIkOptions& options) {
  const auto refuse = [](const std::string& what) {
    throw ArgumentError("differential inverse kinematics: " + what);
  };
  if (!twist.linear.allFinite() || !twist.angular.allFinite())
    refuse("the twist has a number that is not finite");
  if (!(options.seconds >= 0 && std::isfinite(options.seconds)))
    refuse(fmt::format("seconds is {}; it must be 0 or more", options.seconds));
  if (!(options.posture_rate >= 0 && std::isfinite(options.posture_rate)))
    refuse(fmt::format("posture_rate is {}; it must be 0 or more", options.posture_rate));
  if (!(options.length >= 0 && std::isfinite(options.length)))
    refuse(fmt::format("length is {}; it must be 0 or more", options.length));
  if (!options.posture.empty())
    chain.RequireJointValues("differential inverse kinematics: posture", options.posture);
  if (options.frame == TwistFrame::kWorld) RequireBase(options.base_in_world);
  if (options.max_speed.empty()) return;
  chain.RequireJointValues("differential inverse kinematics: max_speed", options.max_speed);
  for (int i = 0; i < chain.n_joints(); ++i) {
    if (options.max_speed[i] > 0) continue;
    refuse(fmt::format("max_speed of joint '{}' is {}; it must be more than 0",
                       chain.joints()[i].name, options.max_speed[i]));
  }
}

struct Bounds {
  double lower = 0, upper = 0;
};

// Returns the speed limits of joint i.
Bounds BoundsOf(const ChainModel& chain, int i, double q, const DifferentialIkOptions& options) {
  if (options.locked[i]) return {0, 0};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double most = options.max_speed.empty() ? kInfinity : options.max_speed[i];
  if (options.seconds == 0) return {-most, most};
  const JointModel& joint = chain.joints[i];
  return {std::clamp((joint.lower - q) / options.seconds, -most, most),
          std::clamp((joint.upper - q) / options.seconds, -most, most)};
}

// Returns the axes of the twist in the base frame.
Eigen::Matrix3d AxesOf(const DifferentialIkOptions& options, const Pose& tip) {
  if (options.frame == TwistFrame::kTip) return tip.rotation();
  if (options.frame == TwistFrame::kWorld) return options.base_in_world.transpose();
  return Eigen::Matrix3d::Identity();
}

}  // namespace

DifferentialIkResult DifferentialIk(const Chain& chain, std::span<const double> q,
                                    const Twist& twist, const DifferentialIkOptions& options) {
  RequireDifferentialIk(chain, twist, options);
  const int n = chain.n_joints();
  const double per_metre = 1 / (options.length > 0 ? options.length : chain.model().length);
  Jacobian6 jacobian(6, n);
  const Pose tip = chain.Jacobian(q, jacobian);
  const Eigen::Matrix3d axes = AxesOf(options, tip);
  Vector6 task;
  task << axes * twist.linear * per_metre, axes * twist.angular;
  jacobian.topRows<3>() *= per_metre;
  // Speeds of slides are in lengths too: neither the damping nor the distance to a singularity
  // depends on metres.
  for (int i = 0; i < n; ++i) jacobian.col(i) *= UnitOf(chain.model(), i);

  BoundedLeastSquares squares(jacobian, task);
  std::array<Bounds, kMaxChainJoints> bounds;
  for (int i = 0; i < n; ++i) {
    const double unit = UnitOf(chain.model(), i);
    bounds[i] = BoundsOf(chain.model(), i, q[i], options);
    squares.lower[i] = bounds[i].lower / unit;
    squares.upper[i] = bounds[i].upper / unit;
    if (!options.posture.empty())
      squares.preferred[i] = options.posture_rate * (options.posture[i] - q[i]) / unit;
  }
  DifferentialIkResult result{.velocity = JointVector(n)};
  SolveDamped(jacobian, &squares, result.velocity.data());

  Vector6 moved = Vector6::Zero();
  for (int i = 0; i < n; ++i) moved += jacobian.col(i) * result.velocity[i];
  result.slower = (moved - task).stableNorm() > kNoticed * task.stableNorm() + kStill;
  result.twist.linear = axes.transpose() * moved.head<3>() / per_metre;
  result.twist.angular = axes.transpose() * moved.tail<3>();

  for (int i = 0; i < n; ++i) {
    double& v = result.velocity[i];
    // A joint at a bound is there to the bit.
    v = v == squares.lower[i] ? bounds[i].lower
        : v == squares.upper[i]
            ? bounds[i].upper
            : std::clamp(UnitOf(chain.model(), i) * v, bounds[i].lower, bounds[i].upper);
  }
  return result;
}

}  // namespace robocell
