#include "robocell/control/cartesian_pose_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>

#include "robocell/base/error.h"
#include "robocell/kinematics/pose_error.h"
#include "robocell/robot/joint_torque_controller.h"
#include "robocell/robot/task_space.h"

namespace robocell {
namespace {

using Jacobian6 = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxChainJoints>;
using JointColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxChainJoints, 1>;
using Rows3 = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxChainJoints>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Keeps joint speeds bounded near singularities: least squares weigh the error against the motion.
constexpr double kDamping = 1e-4;
constexpr double kLeak = 1e-8;               // the damping of null spaces
constexpr double kPostureRate = 1;           // 1/s
constexpr double kLongestTick = 0.1;         // s; avoids a jump after a pause
constexpr double kLargestJointSpeed = M_PI;  // rad/s or m/s
// Largest lead of the reference over the joints, m and rad. It keeps the reference near the joints
// if the target is unreachable.
constexpr double kLongestLead = 0.02, kWidestLead = 0.1;

// Returns the joint step that comes nearest to a step of the tip in base axes, linear rows first.
JointColumn StepOfPose(const Jacobian6& jacobian, const Vector6& task, const JointColumn& spare) {
  Matrix6 squared = jacobian * jacobian.transpose();
  squared.diagonal().array() += kDamping;
  const Vector6 weighted = squared.llt().solve(task - jacobian * spare);
  return spare + jacobian.transpose() * weighted;
}

// The same for arms of few joints: the rotation does not take the tip off its position.
JointColumn StepPositionFirst(const Jacobian6& jacobian, const Vector6& task,
                              const JointColumn& spare) {
  const Rows3 linear = jacobian.topRows<3>();
  Eigen::Matrix3d squared = linear * linear.transpose();
  squared.diagonal().array() += kDamping;
  const auto solved = squared.llt();
  const JointColumn first = linear.transpose() * solved.solve(task.head<3>());
  // The null space has less damping: what leaks out of it moves the tip.
  Eigen::Matrix3d exact = linear * linear.transpose();
  exact.diagonal().array() += kLeak;
  const auto inverse = exact.llt();
  const auto in_null_space = [&](const JointColumn& step) -> JointColumn {
    return step - linear.transpose() * inverse.solve(linear * step);
  };
  Rows3 angular = jacobian.bottomRows<3>();
  const Eigen::Vector3d rest = task.tail<3>() - angular * first;
  for (Eigen::Index i = 0; i < 3; ++i)
    angular.row(i) = in_null_space(angular.row(i).transpose()).transpose();
  Eigen::Matrix3d turned = angular * angular.transpose();
  turned.diagonal().array() += kDamping;
  return first + in_null_space(spare) +
         in_null_space(angular.transpose() * turned.llt().solve(rest));
}

std::shared_ptr<const internal::TaskSpace> MakeTaskSpace(const ArmGroup& arm) {
  const auto config = arm.task_space();
  return config ? std::make_shared<const internal::TaskSpace>(*config)
                : std::make_shared<const internal::TaskSpace>();
}

[[maybe_unused]] const bool kCartesianPoseRegistered = [] {
  RegisterController("cartesian_pose", [](MoveGroup& group) -> std::unique_ptr<Controller> {
    return std::make_unique<CartesianPoseController>(internal::RequireArm(group, "cartesian_pose"));
  });
  return true;
}();

}  // namespace

CartesianPoseController::CartesianPoseController(ArmGroup& arm)
    : arm_(arm), task_space_(MakeTaskSpace(arm)), servos_(arm), posture_(arm.nq()) {
  arm_.chain();  // throws at once if there is none
  Reset();
}

void CartesianPoseController::SetTarget(std::span<const double> numbers) {
  target_ = ToNumbers(PoseFromNumbers(numbers, arm_));
}

Pose CartesianPoseController::pose() const { return PoseFromNumbers(target_, arm_); }

void CartesianPoseController::SetMaxSpeeds(double linear, double angular) {
  if (!(linear > 0 && angular > 0 && std::isfinite(linear) && std::isfinite(angular))) {
    throw ArgumentError(
        fmt::format("{}: the largest speeds cannot be {} m/s and {} rad/s; both "
                    "must be above 0",
                    arm_.place(), linear, angular));
  }
  max_linear_speed_ = linear;
  max_angular_speed_ = angular;
}

void CartesianPoseController::SetPosture(std::span<const double> q) {
  RequireValues([&] { return arm_.place(); }, "joint", q, arm_.nq(), arm_.joint_names());
  std::copy(q.begin(), q.end(), posture_.begin());
}

void CartesianPoseController::Reset() {
  servos_.Reset();
  HoldServos();
}

void CartesianPoseController::ResetTo(std::span<const double> servos) {
  servos_.ResetTo(servos);
  HoldServos();
}

// Sets the target to that of the servos.
void CartesianPoseController::HoldServos() {
  const std::span<const double> q = servos_.target();
  std::copy(q.begin(), q.end(), posture_.begin());
  const Pose here = arm_.chain().Fk(q);
  reference_ = ToTransform(here);
  target_ = ToNumbers(here);
  time_ = arm_.time();
}

void CartesianPoseController::MoveReference(double seconds) {
  const Pose target =
      task_space_->is_part() ? task_space_->Nearest(pose(), reference_.pose()) : pose();
  const internal::PoseError error = internal::ErrorTo(ToTransform(target), reference_);
  const double distance = error.linear.norm(), angle = error.angular.norm();
  // Both arrive together.
  const double needed = std::max(distance / max_linear_speed_, angle / max_angular_speed_);
  const double share = needed > seconds ? seconds / needed : 1;
  reference_.translation += share * error.linear;
  if (angle > 0) {
    const Eigen::AngleAxisd turn(share * angle, error.angular / angle);
    reference_.rotation = turn.toRotationMatrix() * reference_.rotation;
  }
}

void CartesianPoseController::HoldReferenceBack() {
  const Transform commanded = ToTransform(arm_.chain().Fk(servos_.target()));
  const internal::PoseError lead = internal::ErrorTo(reference_, commanded);
  const double distance = lead.linear.norm(), angle = lead.angular.norm();
  if (distance > kLongestLead)
    reference_.translation = commanded.translation + kLongestLead / distance * lead.linear;
  if (angle > kWidestLead) {
    const Eigen::AngleAxisd turn(kWidestLead, lead.angular / angle);
    reference_.rotation = turn.toRotationMatrix() * commanded.rotation;
  }
}

void CartesianPoseController::FollowReference(double seconds) {
  const Chain& chain = arm_.chain();
  const int n = chain.n_joints();
  const std::span<double> q = servos_.command_port();
  Jacobian6 jacobian(6, n);
  const Pose tip = chain.Jacobian(q, jacobian);
  const internal::PoseError error = internal::ErrorTo(reference_, ToTransform(tip));
  JointColumn spare(n);
  for (int i = 0; i < n; ++i) spare[i] = kPostureRate * seconds * (posture_[i] - q[i]);
  Vector6 task;
  task << error.linear, error.angular;
  if (task_space_->is_weighted())
    task_space_->Project(pose(), reference_.pose(), tip, task, jacobian);
  const JointColumn step = task_space_->reaches_position_first(chain)
                               ? StepPositionFirst(jacobian, task, spare)
                               : StepOfPose(jacobian, task, spare);
  const double largest = kLargestJointSpeed * seconds;
  const double scale = std::min(1.0, largest / std::max(step.cwiseAbs().maxCoeff(), 1e-300));
  for (int i = 0; i < n; ++i) {
    const ChainJoint& joint = chain.joints()[i];
    q[i] = std::clamp(q[i] + scale * step[i], joint.lower, joint.upper);
  }
}

void CartesianPoseController::Compute(std::span<double> ctrl) {
  const double now = arm_.time();
  const double seconds = std::clamp(now - time_, 0.0, kLongestTick);
  time_ = now;
  if (seconds > 0) {
    MoveReference(seconds);
    FollowReference(seconds);
    HoldReferenceBack();
  }
  servos_.Compute(ctrl);
}

}  // namespace robocell
