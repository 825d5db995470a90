#include "robocell/kinematics/ik_position_first.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "robocell/base/error.h"
#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/ik_step.h"
#include "robocell/math/rotation.h"

namespace robocell::internal {
namespace {

constexpr int kDegrees = 6;  // of freedom of a pose
constexpr int kMostSteps = 200;
constexpr double kLargestStep = 0.2;       // rad or chain lengths
constexpr double kPositionDamping = 1e-4;  // share of the chain's length
constexpr double kRotationDamping = 1e-2;  // rad
constexpr double kAtRest = 1e-8;           // rad or chain lengths: the last step
constexpr int kRestarts = 32;

using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kDegrees>;
using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kDegrees>;
using Joints = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kDegrees, 1>;
using Square =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kDegrees, kDegrees>;
using Inverse = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, kDegrees, 3>;

Inverse DampedInverse(const Rows& rows, double damping) {
  const Eigen::Matrix3d square =
      rows * rows.transpose() + damping * damping * Eigen::Matrix3d::Identity();
  return rows.transpose() * square.ldlt().solve(Eigen::Matrix3d::Identity());
}

class Descent {
 public:
  Descent(const Chain& chain, const Pose& target)
      : chain_(chain), target_(target), n_(chain.n_joints()) {}

  IkResult From(JointVector q) const {
    Clamp(q);
    Joints step = Joints::Zero(n_);
    IkResult result;
    for (result.iterations = 0; result.iterations < kMostSteps; ++result.iterations) {
      step = StepAt(q);
      for (int i = 0; i < n_; ++i) q[i] += step[i] * UnitOf(chain_.model(), i);
      Clamp(q);
      if (step.cwiseAbs().maxCoeff() < kAtRest) break;
    }
    const Pose tip = chain_.Fk(q);
    result.q = q;
    result.position_error = (target_.translation() - tip.translation()).norm();
    result.rotation_error = AngleBetween(target_.quaternion(), tip.quaternion());
    result.success = result.position_error <= IkOptions{}.tolerance;
    return result;
  }

 private:
  void Clamp(JointVector& q) const {
    for (int i = 0; i < n_; ++i)
      q[i] = std::clamp(q[i], chain_.model().joints[i].lower, chain_.model().joints[i].upper);
  }

  // Returns a step in rad and chain lengths, without joints that would leave their limits.
  Joints StepAt(const JointVector& q) const {
    const double length = chain_.model().length;
    Columns jacobian(6, n_);
    const Pose tip = chain_.Jacobian(q, jacobian);
    Eigen::Vector<double, 6> error;
    error.head<3>() = (target_.translation() - tip.translation()) / length;
    error.tail<3>() =
        Pose(Eigen::Vector3d::Zero(),
             QuaternionProduct(target_.quaternion(), QuaternionInverse(tip.quaternion())))
            .rotvec();
    jacobian.topRows<3>() /= length;
    for (int i = 0; i < n_; ++i) jacobian.col(i) *= UnitOf(chain_.model(), i);
    std::array<bool, kDegrees> held = {};
    Joints step = Joints::Zero(n_);
    for (bool again = true; again;) {
      again = false;
      step = FreeStep(jacobian, error);
      for (int i = 0; i < n_; ++i) {
        const JointModel& limits = chain_.model().joints[i];
        const bool leaves =
            (q[i] >= limits.upper && step[i] > 0) || (q[i] <= limits.lower && step[i] < 0);
        if (!leaves || held[static_cast<size_t>(i)]) continue;
        held[static_cast<size_t>(i)] = again = true;
        jacobian.col(i).setZero();
      }
    }
    const double most = step.cwiseAbs().maxCoeff();
    return most > kLargestStep ? Joints(step * (kLargestStep / most)) : step;
  }

  Joints FreeStep(const Columns& jacobian, const Eigen::Vector<double, 6>& error) const {
    const Rows linear = jacobian.topRows<3>(), angular = jacobian.bottomRows<3>();
    const Inverse inverse = DampedInverse(linear, kPositionDamping);
    const Joints first = inverse * error.head<3>();
    const Square null = Square::Identity(n_, n_) - inverse * linear;
    const Rows left = angular * null;
    const Eigen::Vector3d rest = error.tail<3>() - angular * first;
    return first + null * (DampedInverse(left, kRotationDamping) * rest);
  }

  const Chain& chain_;
  const Pose& target_;
  const int n_;
};

}  // namespace

bool HasFewJoints(const Chain& chain) { return chain.n_joints() < kDegrees; }

IkResult IkPositionFirst(const Chain& chain, const Pose& tip_in_base,
                         std::span<const double> from) {
  chain.RequireJointValues("inverse kinematics", from);
  RequireIkTarget(tip_in_base, "inverse kinematics");
  if (!HasFewJoints(chain))
    throw ArgumentError("inverse kinematics: position first is for fewer than six joints");
  const JointVector seed(from);
  const Descent descent(chain, tip_in_base);
  const IkResult near = descent.From(seed);
  if (near.success) return near;
  const IkResult position = Ik(
      chain, tip_in_base,
      {.seed = seed, .position_only = true, .prefer = IkPrefer::kSeed, .max_restarts = kRestarts});
  if (!position.success) return near;
  const IkResult found = descent.From(position.q);
  const double most = LargestJointStep(chain, chain.Fk(from), tip_in_base);
  for (int i = 0; i < chain.n_joints(); ++i) {
    if (std::abs(found.q[i] - from[i]) > most * UnitOf(chain.model(), i)) return near;
  }
  return found.success ? found : near;
}

}  // namespace robocell::internal
