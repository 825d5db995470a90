#include "robocell/control/cartesian_impedance_controller.h"

#include <algorithm>

#include "robocell/base/few_numbers.h"
#include "robocell/control/joint_impedance_controller.h"
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

constexpr size_t kMaxTriangle = kMaxChainJoints * (kMaxChainJoints + 1) / 2;

constexpr CartesianImpedanceController::Gains kDefaultStiffness = {400, 400, 400, 30, 30, 30};

using Rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
using Position = Eigen::Map<const Eigen::Vector3d>;

// Products entry by entry: those of matrices are calls.
Transform LeafInBase(const LeafView& view) {
  const Rotation base(view.base_rotation), leaf(view.leaf_rotation);
  const Position from(view.base_position), to(view.leaf_position);
  return {base.transpose().lazyProduct(leaf), base.transpose().lazyProduct(to - from)};
}

}  // namespace

CartesianImpedanceController::CartesianImpedanceController(ArmGroup& arm)
    : arm_(arm),
      springs_(MakeLeafSprings(kDefaultStiffness.data())),
      posture_(arm.nq()),
      q_(arm.nq()),
      qd_(arm.nv()) {
  Reset();
}

void CartesianImpedanceController::SetTarget(std::span<const double> numbers) {
  SetPose(PoseFromNumbers(numbers, arm_));
}

Pose CartesianImpedanceController::pose() const { return PoseFromNumbers(target_, arm_); }

void CartesianImpedanceController::SetPose(const Pose& leaf_in_robot) {
  target_ = goal_numbers_ = ToNumbers(leaf_in_robot);
  goal_ = ToTransform(leaf_in_robot);
}

const Transform& CartesianImpedanceController::Goal() {
  if (target_ != goal_numbers_) SetPose(pose());
  return goal_;
}

CartesianImpedanceController::Gains CartesianImpedanceController::stiffness() const {
  return std::to_array(springs_.stiffness);
}

void CartesianImpedanceController::SetStiffness(const Gains& stiffness) {
  PositiveGains(arm_.place(), "stiffness", stiffness, 6);
  springs_ = MakeLeafSprings(stiffness.data());
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
  SetPose(arm_.chain().Fk(q_));
}

void CartesianImpedanceController::Compute(std::span<double> ctrl) {
  arm_.GetJointPos(q_);
  arm_.GetJointVel(qd_);
  const double w = posture_frequency_;
  const size_t n = q_.size();
  double bias[kMaxChainJoints], wanted[kMaxChainJoints], room[kMaxTriangle];
  for (size_t i = 0; i < n; ++i) wanted[i] = w * w * (posture_[i] - q_[i]) - 2 * w * qd_[i];
  const double* mass = arm_.GetBiasAndMass({bias, n}, {room, n * (n + 1) / 2});
  const LeafView view = arm_.leaf_view();
  // Before what takes longer, beside which the processor does it.
  const PoseError error = ErrorTo(Goal(), LeafInBase(view));
  const double deviation[6] = {error.linear[0],  error.linear[1],  error.linear[2],
                               error.angular[0], error.angular[1], error.angular[2]};
  LeafAnswer leaf;
  ComputeLeaf({.view = view,
               .mass = mass,
               .wanted = wanted,
               .velocity = qd_.data(),
               .springs = &springs_,
               .deviation = deviation,
               .feedforward = feedforward_.data(),
               .damping_ratio = damping_ratio_,
               .bias = bias},
              &leaf);
  // What of the state is no number is in all of them.
  if (!FewAreFinite(leaf.torques, n)) arm_.chain().CheckJointValues("q", q_);
  arm_.CtrlForJointTorque({leaf.torques, n}, ctrl);
}

}  // namespace robocell
