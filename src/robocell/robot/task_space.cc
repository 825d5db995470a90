#include "robocell/robot/task_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/kinematics/ik_position_first.h"
#include "robocell/kinematics/ik_step.h"
#include "robocell/math/rotation.h"

namespace robocell::internal {
namespace {

bool HasZero(const std::optional<Vec3>& weights) {
  return weights && std::ranges::any_of(*weights, [](double w) { return w == 0; });
}

// Returns the rotation by the least angle that turns `from` towards `to`, up to `left` rad of it.
Quaternion LeastTurn(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double left) {
  const Eigen::Vector3d cross = from.cross(to);
  const double angle = std::atan2(cross.norm(), from.dot(to));
  if (angle <= left) return QuaternionFromRotvec(Eigen::Vector3d::Zero());
  // Opposite directions: any normal axis.
  const Eigen::Vector3d normal = cross.norm() > 0 ? cross : from.unitOrthogonal();
  return QuaternionFromRotvec((angle - left) * normal.normalized());
}

}  // namespace

TaskSpace::TaskSpace(const TaskSpaceConfig& config) : is_configured_(true), config_(config) {
  if (config.axis) axis_ = ToEigen(*config.axis).normalized();
  is_part_ = config.kind != TaskSpaceKind::kPose || HasZero(config.position_weights) ||
             HasZero(config.rotation_weights);
}

void TaskSpace::ApplyTo(IkOptions& options) const {
  if (!is_configured_) return;
  options.position_only = config_.kind == TaskSpaceKind::kPosition;
  if (config_.kind == TaskSpaceKind::kAxis) {
    options.axis = axis_;
    options.cone = config_.cone.value_or(0);
  }
  if (config_.position_weights) options.position_weights = *config_.position_weights;
  if (config_.rotation_weights) options.rotation_weights = *config_.rotation_weights;
}

bool TaskSpace::reaches_position_first(const Chain& chain) const {
  return !is_configured_ && HasFewJoints(chain);
}

Pose TaskSpace::Nearest(const Pose& target, const Pose& tip) const {
  if (!is_part_) return target;
  Eigen::Vector3d position = target.translation();
  Quaternion rotation = target.quaternion();
  if (HasZero(config_.position_weights)) {
    Eigen::Vector3d shift =
        Rotate(QuaternionInverse(target.quaternion()), tip.translation() - target.translation());
    for (int i = 0; i < 3; ++i) {
      if ((*config_.position_weights)[static_cast<size_t>(i)] != 0) shift[i] = 0;
    }
    position += Rotate(target.quaternion(), shift);
  }
  const auto turn_axis = [&](const Eigen::Vector3d& axis, double cone) {
    const Quaternion turn =
        LeastTurn(Rotate(tip.quaternion(), axis), Rotate(target.quaternion(), axis), cone);
    rotation = QuaternionProduct(turn, tip.quaternion());
  };
  if (config_.kind == TaskSpaceKind::kPosition) {
    rotation = tip.quaternion();
  } else if (config_.kind == TaskSpaceKind::kAxis) {
    turn_axis(axis_, config_.cone.value_or(0));
  } else if (HasZero(config_.rotation_weights)) {
    const Vec3& weights = *config_.rotation_weights;
    const auto zeros = std::ranges::count(weights, 0.0);
    if (zeros == 3) {
      rotation = tip.quaternion();
    } else if (zeros == 1) {
      const auto free = std::ranges::find(weights, 0.0) - weights.begin();
      turn_axis(Eigen::Vector3d::Unit(static_cast<Eigen::Index>(free)), 0);
    }
  }
  return {position, rotation};
}

IkResult TaskSpace::Step(const Chain& chain, const Pose& tip_in_base,
                         std::span<const double> from) const {
  if (!is_part_ && !config_.position_weights && !config_.rotation_weights) {
    IkResult found = IkStep(chain, tip_in_base, from);
    if (!found.success && reaches_position_first(chain))
      found = IkPositionFirst(chain, tip_in_base, from);
    return found;
  }
  IkOptions options;
  ApplyTo(options);
  return IkStep(chain, Nearest(tip_in_base, chain.Fk(from)), from, options);
}

IkResult TaskSpace::Solve(const Chain& chain, const Pose& tip_in_base, IkOptions options) const {
  ApplyTo(options);
  const IkResult found = Ik(chain, tip_in_base, options);
  const bool is_locked = std::ranges::any_of(options.locked, [](bool locked) { return locked; });
  if (found.success || is_locked || options.seed.empty() || !reaches_position_first(chain))
    return found;
  const IkResult nearest = IkPositionFirst(chain, tip_in_base, options.seed);
  return nearest.success ? nearest : found;
}

void TaskSpace::Project(const Pose& tip, Eigen::Ref<Eigen::Vector<double, 6>> error,
                        Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> jacobian) const {
  if (config_.kind == TaskSpaceKind::kPosition) {
    error.tail<3>().setZero();
    jacobian.bottomRows<3>().setZero();
  } else if (config_.kind == TaskSpaceKind::kAxis) {
    const Eigen::Vector3d axis = Rotate(tip.quaternion(), axis_);
    error.tail<3>() -= axis * axis.dot(error.tail<3>());
    for (Eigen::Index i = 0; i < jacobian.cols(); ++i) {
      const Eigen::Vector3d turn = jacobian.col(i).tail<3>();
      jacobian.col(i).tail<3>() = turn - axis * axis.dot(turn);
    }
  }
}

std::string TaskSpace::text() const {
  if (!is_configured_) return "";
  switch (config_.kind) {
    case TaskSpaceKind::kPosition:
      return "the position alone";
    case TaskSpaceKind::kAxis:
      return fmt::format("the position, and the direction of the TCP's axis [{:g}, {:g}, {:g}]",
                         axis_[0], axis_[1], axis_[2]);
    case TaskSpaceKind::kPose:
      break;
  }
  return is_part_ ? "the part of the pose whose weights are not 0" : "the whole pose";
}

TaskSpace TaskSpaceOf(const RobotConfig& config, const std::string& group) {
  const MoveGroupConfig* found = config.move_groups.find(group);
  return found && found->task_space ? TaskSpace(*found->task_space) : TaskSpace();
}

}  // namespace robocell::internal
