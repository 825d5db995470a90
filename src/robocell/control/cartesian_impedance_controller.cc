#include "robocell/control/cartesian_impedance_controller.h"

#include <algorithm>

#include "robocell/control/joint_impedance_controller.h"
#include "robocell/control/leaf_kernel.h"
#include "robocell/kinematics/link_answer.h"
#include "robocell/kinematics/pose_error.h"
#include "robocell/robot/joint_torque_controller.h"

namespace robocell {
namespace {

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

}  // namespace

CartesianImpedanceController::CartesianImpedanceController(ArmGroup& arm)
    : arm_(arm), posture_(arm.nq()), q_(arm.nq()), qd_(arm.nv()), wanted_(arm.nv()) {
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
  arm_.GetJointPos(q_);
  arm_.GetJointVel(qd_);
  chain.CheckJointValues("q", q_);
  const double w = posture_frequency_;
  for (size_t i = 0; i < q_.size(); ++i)
    wanted_[i] = w * w * (posture_[i] - q_[i]) - 2 * w * qd_[i];

  LinkAnswer links;
  ComputeLinks(chain.links(), LinkPart::kJacobian, {.q = q_.data()}, &links);
  const int n = chain.n_joints();
  Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<kMaxChainJoints>> mass(links.mass[0], n, n);
  arm_.GetBiasAndMass({links.torques, q_.size()}, mass);
  for (int i = 0; i < n; ++i) {
    double needed = links.torques[i];
    for (int k = 0; k < n; ++k) needed += links.mass[i][k] * wanted_[k];
    links.torques[i] = needed;
  }
  // Before what takes longer, beside which the processor does it.
  const PoseError error = ErrorTo(ToTransform(pose()), TipOf(links));
  const double deviation[6] = {error.linear[0],  error.linear[1],  error.linear[2],
                               error.angular[0], error.angular[1], error.angular[2]};
  LeafAnswer leaf;
  ComputeLeaf({.n = n,
               .jacobian = links.jacobian,
               .mass = links.mass,
               .velocity = qd_.data(),
               .wanted = wanted_.data(),
               .stiffness = stiffness_.data(),
               .deviation = deviation,
               .feedforward = feedforward_.data(),
               .damping_ratio = damping_ratio_,
               .torques = links.torques},
              &leaf);
  arm_.CtrlForJointTorque({leaf.torques, q_.size()}, ctrl);
}

}  // namespace robocell
