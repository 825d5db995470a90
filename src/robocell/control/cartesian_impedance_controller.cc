#include "robocell/control/cartesian_impedance_controller.h"

#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "robocell/control/joint_impedance_controller.h"
#include "robocell/kinematics/pose_error.h"
#include "robocell/robot/joint_torque_controller.h"

namespace robocell {
namespace {

using Jacobian6 = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxChainJoints>;
using JointColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxChainJoints, 1>;
using JointColumns6 = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, kMaxChainJoints, 6>;
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                  kMaxChainJoints, kMaxChainJoints>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Where the leaf cannot be moved it seems to be infinitely heavy; this bounds it, 1/kg.
constexpr double kLeastMobility = 1e-6;

[[maybe_unused]] const bool kCartesianImpedanceRegistered = [] {
  RegisterController(
      "cartesian_impedance",
      [](MoveGroup& group) -> std::unique_ptr<Controller> {
        return std::make_unique<CartesianImpedanceController>(
            RequireArm(group, "cartesian_impedance"));
      },
      CtrlMode::kTorque);
  return true;
}();

// The force of the damping with which no motion of a mass on springs overshoots: in coordinates in
// which all springs are alike it is twice the root of the mass.
Vector6 CriticalDampingForce(const Vector6& stiffness, const Matrix6& mobility,
                             const Vector6& velocity) {
  constexpr double kNoSpring = 1e-9;
  const Vector6 root = stiffness.cwiseSqrt();
  Matrix6 scaled = root.asDiagonal() * mobility * root.asDiagonal();
  scaled.diagonal().array() += kNoSpring;
  const Eigen::SelfAdjointEigenSolver<Matrix6> modes(scaled);
  const Vector6 along = modes.eigenvectors().transpose() * root.cwiseProduct(velocity);
  return 2 * root.cwiseProduct(modes.eigenvectors() *
                               along.cwiseQuotient(modes.eigenvalues().cwiseSqrt()));
}

}  // namespace

CartesianImpedanceController::CartesianImpedanceController(ArmGroup& arm)
    : arm_(arm), posture_(arm.nq()), q_(arm.nq()), qd_(arm.nv()), torque_(arm.nv()) {
  Reset();
}

void CartesianImpedanceController::SetTarget(std::span<const double> numbers) {
  target_ = ToNumbers(PoseFromNumbers(numbers, arm_));
}

Pose CartesianImpedanceController::pose() const { return PoseFromNumbers(target_, arm_); }

void CartesianImpedanceController::SetStiffness(const Gains& stiffness) {
  PositiveGains(arm_.place(), "stiffness", stiffness, 6);
  stiffness_ = stiffness;
}

void CartesianImpedanceController::SetDampingRatio(double ratio) {
  damping_ratio_ = PositiveGains(arm_.place(), "damping_ratio", {&ratio, 1}, 1)[0];
}

void CartesianImpedanceController::SetPosture(std::span<const double> q) {
  CheckValues([&] { return arm_.place(); }, "joint", q, arm_.nq(), arm_.joint_names());
  std::copy(q.begin(), q.end(), posture_.begin());
}

void CartesianImpedanceController::SetPostureFrequency(double frequency) {
  posture_frequency_ = PositiveGains(arm_.place(), "posture_frequency", {&frequency, 1}, 1)[0];
}

void CartesianImpedanceController::SetFeedforward(const Gains& wrench) {
  CheckValues([&] { return arm_.place(); }, "feedforward", wrench, 6);
  feedforward_ = wrench;
}

void CartesianImpedanceController::Reset() {
  arm_.GetJointPos(q_);
  posture_ = q_;
  target_ = ToNumbers(arm_.chain().Fk(q_));
}

void CartesianImpedanceController::Compute(std::span<double> ctrl) {
  const Chain& chain = arm_.chain();
  const int n = chain.n_joints();
  arm_.GetJointPos(q_);
  arm_.GetJointVel(qd_);
  const JointColumn qd = Eigen::Map<const Eigen::VectorXd>(qd_.data(), n);

  Jacobian6 jacobian(6, n);
  JointMatrix mass(n, n);
  const PoseError error = ErrorTo(ToTransform(pose()), ToTransform(chain.Jacobian(q_, jacobian)));
  chain.MassMatrix(q_, mass);
  // Root of J M^-1 J^T, what the leaf yields to a force.
  const JointColumns6 root = mass.llt().matrixL().solve(JointColumns6(jacobian.transpose()));
  Matrix6 mobility = root.transpose() * root;
  mobility.diagonal().array() += kLeastMobility;

  Vector6 deviation;
  deviation << error.linear, error.angular;
  const Vector6 velocity = jacobian * qd;
  const Vector6 stiffness = Eigen::Map<const Vector6>(stiffness_.data());
  const Vector6 force = stiffness.cwiseProduct(deviation) -
                        damping_ratio_ * CriticalDampingForce(stiffness, mobility, velocity) +
                        Eigen::Map<const Vector6>(feedforward_.data());

  const double w = posture_frequency_;
  JointColumn wanted(n);  // acceleration of the joints to spare
  for (int i = 0; i < n; ++i) wanted[i] = w * w * (posture_[i] - q_[i]) - 2 * w * qd[i];
  // The force that would accelerate the leaf as they do: it is not to feel them.
  const Vector6 felt = mobility.llt().solve(jacobian * wanted);

  arm_.InverseDynamics(q_, qd_, {wanted.data(), q_.size()}, torque_);
  const JointColumn control = jacobian.transpose() * (force - felt);
  for (int i = 0; i < n; ++i) torque_[i] += control[i];
  arm_.CtrlForJointTorque(torque_, ctrl);
}

}  // namespace robocell
