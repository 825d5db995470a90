#include "robocell/control/cartesian_impedance_controller.h"

#include <algorithm>
#include <cmath>

#include "robocell/base/small_arrays.h"
#include "robocell/control/joint_impedance_controller.h"
#include "robocell/kinematics/link_answer.h"
#include "robocell/math/rotation.h"
#include "robocell/robot/joint_torque_controller.h"

namespace robocell {
namespace {

[[maybe_unused]] const bool kCartesianImpedanceRegistered = [] {
  RegisterController(
      "cartesian_impedance",
      [](MoveGroup& group) -> std::unique_ptr<Controller> {
        return std::make_unique<CartesianImpedanceController>(
            internal::RequireArm(group, "cartesian_impedance"));
      },
      CtrlMode::kTorque);
  return true;
}();

constexpr CartesianImpedanceController::Gains kDefaultStiffness = {400, 400, 400, 30, 30, 30};

// Allowed deviation of a quaternion's squared length from 1, by rounding.
constexpr double kUnitLength = 1e-12;

}  // namespace

CartesianImpedanceController::CartesianImpedanceController(ArmGroup& arm)
    : arm_(arm),
      springs_(MakeTcpSprings(kDefaultStiffness.data())),
      posture_(arm.nq()),
      q_(arm.nq()) {
  Reset();
}

void CartesianImpedanceController::SetTarget(std::span<const double> numbers) {
  SetPose(PoseFromNumbers(numbers, arm_));
}

Pose CartesianImpedanceController::pose() const { return PoseFromNumbers(target_, arm_); }

void CartesianImpedanceController::SetPose(const Pose& leaf_in_robot) {
  target_ = ToNumbers(leaf_in_robot);
}

void CartesianImpedanceController::RequireTarget() {
  const double length2 = target_[3] * target_[3] + target_[4] * target_[4] +
                         target_[5] * target_[5] + target_[6] * target_[6];
  const bool is_pose =
      std::abs(length2 - 1) < kUnitLength && AllFinite(target_.data(), target_.size());
  if (!is_pose) SetPose(pose());
}

CartesianImpedanceController::Gains CartesianImpedanceController::stiffness() const {
  return std::to_array(springs_.stiffness);
}

void CartesianImpedanceController::SetStiffness(const Gains& stiffness) {
  PositiveGains(arm_.place(), "stiffness", stiffness, 6);
  springs_ = MakeTcpSprings(stiffness.data());
}

void CartesianImpedanceController::SetDampingRatio(double ratio) {
  damping_ratio_ = PositiveGains(arm_.place(), "damping_ratio", {&ratio, 1}, 1)[0];
}

void CartesianImpedanceController::SetPosture(std::span<const double> q) {
  RequireValues([&] { return arm_.place(); }, "joint", q, arm_.nq(), arm_.joint_names());
  std::copy(q.begin(), q.end(), posture_.begin());
}

void CartesianImpedanceController::SetPostureFrequency(double frequency) {
  posture_frequency_ = PositiveGains(arm_.place(), "posture_frequency", {&frequency, 1}, 1)[0];
}

void CartesianImpedanceController::SetFeedforward(const Gains& wrench) {
  RequireValues([&] { return arm_.place(); }, "feedforward", wrench, 6);
  feedforward_ = wrench;
}

void CartesianImpedanceController::Reset() {
  arm_.GetJointPos(q_);
  posture_ = q_;
  SetPose(arm_.chain().Fk(q_));
}

void CartesianImpedanceController::Compute(std::span<double> ctrl) {
  double qd[kMaxChainJoints];
  arm_.GetJointPos(q_);
  arm_.GetJointVel({qd, q_.size()});
  RequireTarget();
  const Eigen::Matrix3d goal =
      MatrixFromQuaternion({target_[3], target_[4], target_[5], target_[6]});
  const double w = posture_frequency_;
  const size_t n = q_.size();
  double wanted[kMaxChainJoints];
  for (size_t i = 0; i < n; ++i) wanted[i] = w * w * (posture_[i] - q_[i]) - 2 * w * qd[i];
  const Chain& chain = arm_.chain();
  const Eigen::Vector3d gravity = arm_.gravity_in_base();
  internal::LinkAnswer links;
  internal::ComputeChain(chain, internal::LinkPart::kAll,
                         {.q = q_.data(), .qd = qd, .gravity = gravity.data()}, &links);
  for (const JointCoupling& c : chain.couplings()) links.mass[c.second][c.first] += c.inertia;
  OperationalSpaceResult leaf;
  ComputeOperationalSpace({.n = chain.n_joints(),
                           .arm = &links,
                           .wanted = wanted,
                           .velocity = qd,
                           .springs = &springs_,
                           .goal = {target_.data(), goal.data()},
                           .feedforward = feedforward_.data(),
                           .damping_ratio = damping_ratio_},
                          &leaf);
  // A NaN of the state makes all torques NaN.
  if (!AllFinite(leaf.torques, n)) chain.RequireJointValues("q", q_);
  arm_.CtrlForJointTorque({leaf.torques, n}, ctrl);
}

}  // namespace robocell
