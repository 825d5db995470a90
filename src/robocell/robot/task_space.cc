#include "robocell/robot/task_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "robocell/kinematics/ik_position_first.h"
#include "robocell/kinematics/ik_step.h"
#include "robocell/math/rotation.h"
#include "robocell/robot/robot.h"

namespace robocell::internal {
namespace {

// The tolerances of a solution for a grasp, m and rad.
constexpr double kGraspTolerance = 1e-4;
constexpr int kGraspRestarts = 40;
constexpr double kHalfTurn = 1e-12;  // the cosine of half the angle of a rotation by half a turn

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

int CountZeros(const Eigen::Vector3d& v) { return static_cast<int>((v.array() == 0).count()); }

Eigen::Index IndexOfZero(const Eigen::Vector3d& v) {
  Eigen::Index at = 0;
  v.minCoeff(&at);
  return at;
}

size_t IndexOfLargest(const Eigen::Vector3d& v) {
  Eigen::Index at = 0;
  v.maxCoeff(&at);
  return static_cast<size_t>(at);
}

// The rotations whose rotation vector from the target, in its axes, has no component `k`: with one
// rotation weight above 0 these are accepted. As unit quaternions relative to the target they are
// those with q[k] = 0, a great sphere, whose distances have closed forms.

// Returns the one nearest to `tip`; all are equally near after half a turn about the axis.
Quaternion NearestWithoutTurn(const Quaternion& target, const Quaternion& tip, size_t k) {
  Quaternion q = QuaternionProduct(QuaternionInverse(target), tip);
  q[k] = 0;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (norm < kHalfTurn) return target;
  for (double& number : q) number /= norm;
  return QuaternionProduct(target, q);
}

// A signed distance from these rotations, and the direction of its growth.
struct TurnLeft {
  Eigen::Vector3d direction;  // in base axes, unit length
  double angle = 0;           // rad, from the tip to the reference
};
TurnLeft TurnAbout(const Quaternion& target, const Quaternion& reference, const Quaternion& tip,
                   size_t k) {
  const Quaternion back = QuaternionInverse(target);
  const Quaternion q = QuaternionProduct(back, tip), to = QuaternionProduct(back, reference);
  // q and -q are one rotation: the signs that are next to each other.
  const double sign = q[0] * to[0] + q[1] * to[1] + q[2] * to[2] + q[3] * to[3] < 0 ? -1 : 1;
  const size_t i = (k + 1) % 3, j = (k + 2) % 3;
  Eigen::Vector3d direction;  // the derivative of q[k] by the angular velocity, in target axes
  direction[static_cast<Eigen::Index>(k)] = q[3];
  direction[static_cast<Eigen::Index>(i)] = q[j];
  direction[static_cast<Eigen::Index>(j)] = -q[i];
  const double norm = direction.norm();
  direction = norm < kHalfTurn ? Eigen::Vector3d::Unit(static_cast<Eigen::Index>(k))
                               : Eigen::Vector3d(direction / norm);
  const auto angle = [](double sine) { return 2 * std::asin(std::clamp(sine, -1.0, 1.0)); };
  return {Rotate(target, direction), angle(sign * to[k]) - angle(q[k])};
}

// Returns the matrix that weighs vectors along the axes of a rotation.
Eigen::Matrix3d Weighing(const Quaternion& axes, const Eigen::Vector3d& weights) {
  const Eigen::Matrix3d rotation = MatrixFromQuaternion(axes);
  return rotation * weights.asDiagonal() * rotation.transpose();
}

}  // namespace

TaskSpace::TaskSpace(const TaskSpaceConfig& config) : is_configured_(true), config_(config) {
  if (config.axis) axis_ = ToEigen(*config.axis).normalized();
  if (config.position_weights) position_share_ = ToEigen(*config.position_weights);
  if (config.rotation_weights) rotation_share_ = ToEigen(*config.rotation_weights);
  const double rotations = config.kind == TaskSpaceKind::kPosition ? 0 : rotation_share_.maxCoeff();
  const double largest = std::max(position_share_.maxCoeff(), rotations);
  if (largest > 0) {
    position_share_ /= largest;
    rotation_share_ /= largest;
  }
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
    const Eigen::Vector3d& weights = rotation_share_;
    const int zeros = CountZeros(weights);
    if (zeros == 3) {
      rotation = tip.quaternion();
    } else if (zeros == 2) {
      rotation = NearestWithoutTurn(target.quaternion(), tip.quaternion(), IndexOfLargest(weights));
    } else {
      turn_axis(Eigen::Vector3d::Unit(IndexOfZero(weights)), 0);
    }
  }
  return {position, rotation};
}

IkResult TaskSpace::Step(const Chain& chain, const Pose& tip_in_base,
                         std::span<const double> from) const {
  if (!is_weighted()) {
    IkResult found = IkStep(chain, tip_in_base, from);
    if (!found.success && reaches_position_first(chain))
      found = IkPositionFirst(chain, tip_in_base, from);
    return found;
  }
  IkOptions options;
  ApplyTo(options);
  // The target itself: weights are along its axes, and the cone is around its direction.
  const Pose tip = chain.Fk(from);
  return IkStep(chain, tip_in_base, from, options,
                LargestJointStep(chain, tip, Nearest(tip_in_base, tip)));
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

IkResult TaskSpace::SolveWithin(const Chain& chain, const Pose& tip_in_base,
                                std::span<const double> from, double tilt) const {
  if (reaches_position_first(chain)) {
    IkResult found = IkPositionFirst(chain, tip_in_base, from);
    found.success = found.success && found.rotation_error <= tilt;
    return found;
  }
  IkOptions options{.tolerance = kGraspTolerance,
                    .seed = JointVector(from),
                    .prefer = IkPrefer::kSeed,
                    .max_restarts = kGraspRestarts};
  if (!is_part_) return {.q = options.seed};
  ApplyTo(options);
  options.position_weights = {1, 1, 1};  // the object is where it is
  const auto n = static_cast<size_t>(chain.n_joints());
  options.filter = [&chain, &tip_in_base, tilt, n](std::span<const double> q, int count,
                                                   std::span<uint8_t> keep) {
    for (size_t i = 0; i < static_cast<size_t>(count); ++i) {
      const Pose tip = chain.Fk(q.subspan(i * n, n));
      keep[i] = AngleBetween(tip.quaternion(), tip_in_base.quaternion()) <= tilt ? 1 : 0;
    }
  };
  return Ik(chain, tip_in_base, options);
}

void TaskSpace::Project(const Pose& target, const Pose& reference, const Pose& tip,
                        Eigen::Ref<Eigen::Vector<double, 6>> error,
                        Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> jacobian) const {
  if (!is_weighted()) return;
  const auto weigh = [&](Eigen::Index first, const Eigen::Matrix3d& matrix) {
    error.segment<3>(first) = (matrix * error.segment<3>(first)).eval();
    for (Eigen::Index i = 0; i < jacobian.cols(); ++i)
      jacobian.col(i).segment<3>(first) = (matrix * jacobian.col(i).segment<3>(first)).eval();
  };
  if (config_.position_weights) weigh(0, Weighing(target.quaternion(), position_share_));
  const int zeros = CountZeros(rotation_share_);
  if (config_.kind == TaskSpaceKind::kPosition || zeros == 3) {
    weigh(3, Eigen::Matrix3d::Zero());
  } else if (config_.kind == TaskSpaceKind::kAxis) {
    const Eigen::Vector3d axis = Rotate(tip.quaternion(), axis_);
    weigh(3, rotation_share_[0] * (Eigen::Matrix3d::Identity() - axis * axis.transpose()));
  } else if (zeros == 2) {
    const size_t k = IndexOfLargest(rotation_share_);
    const TurnLeft turn =
        TurnAbout(target.quaternion(), reference.quaternion(), tip.quaternion(), k);
    const double share = rotation_share_[static_cast<Eigen::Index>(k)];
    weigh(3, share * turn.direction * turn.direction.transpose());
    error.tail<3>() = share * turn.angle * turn.direction;
  } else if (zeros == 1) {
    // The target's axes, with the one that does not count along that of the tip.
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(IndexOfZero(rotation_share_));
    const Quaternion swing =
        LeastTurn(Rotate(target.quaternion(), axis), Rotate(tip.quaternion(), axis), 0);
    weigh(3, Weighing(QuaternionProduct(swing, target.quaternion()), rotation_share_));
  } else {
    weigh(3, Weighing(target.quaternion(), rotation_share_));
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

TaskSpace TaskSpaceOf(const Robot& robot) {
  return TaskSpaceOf(robot.config(), robot.arm().name());
}

bool ChoosesPart(const IkOptions& options) {
  const IkOptions all;
  return options.position_only || options.axis ||
         options.position_weights != all.position_weights ||
         options.rotation_weights != all.rotation_weights;
}

}  // namespace robocell::internal
