#include "robocell/env/arm_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/env/env_scene.h"

namespace robocell {
namespace {

constexpr double kSettling = 0.05;  // s: within its motion an arm at rest stays in its tolerance
constexpr double kWindow = 0.05;    // s, over which a gripper is watched
constexpr double kStill = 1e-3;     // of its opening, within a window

std::optional<Robot> RobotWithGripper(const EnvConfig& config, const Robot& robot) {
  if (config.has_mounted_gripper(robot.name()))
    return Robot::Of(robot.scene(), MountedGripperName(robot.name()));
  return robot.has_gripper() ? std::optional<Robot>(robot) : std::nullopt;
}

std::span<const double> PartOf(std::span<const double> vector, const VectorPart& part) {
  return vector.subspan(part.begin, part.size);
}

std::vector<double> PositionsOf(std::span<const double> values) {
  return {values.begin(), values.end()};
}

}  // namespace

ArmDriver::ArmDriver(const EnvConfig& config, Robot robot, RobotLayout layout)
    : mode_(config.control_mode),
      relative_to_(config.relative_to),
      limit_(config.step_limit()),
      binary_gripper_(config.wrappers.binary_gripper),
      tolerance_(robot.config().arrival_tolerance),
      robot_(std::move(robot)),
      gripper_(RobotWithGripper(config, robot_)),
      layout_(std::move(layout)),
      joint_limits_(CommandLimits(robot_)),
      base_in_shared_(robot_.scene().shared_base_frame_to_world().inverse() *
                      robot_.base_in_world()) {}

std::vector<Robot> ArmDriver::robots() const {
  std::vector<Robot> robots = {robot_};
  if (gripper_ && gripper_->name() != robot_.name()) robots.push_back(*gripper_);
  return robots;
}

void ArmDriver::Reset() {
  sent_joints_ = PositionsOf(robot_.controller(robot_.arm().name()).commanded_joint_pos());
  sent_ = base_in_shared_ * robot_.FkFrame(sent_joints_);
  if (gripper_) sent_opening_ = Opening(gripper_->controller(gripper()->name()).target()[0]);
  gripper_still_ = false;
  window_start_ = robot_.scene().time();
  window_opening_ = gripper_ ? gripper()->opening() : 0;
  SetOriginToCurrent();
}

void ArmDriver::SetOriginToCurrent() {
  origin_ = sent_;
  origin_joints_ = sent_joints_;
}

void ArmDriver::Check(std::span<const double> action, const std::string& place) const {
  const auto fail = [&](const std::string& message) {
    throw ArgumentError(fmt::format("{} / robot '{}': {}", place, layout_.robot, message));
  };
  const std::span<const double> command = PartOf(action, layout_.action);
  for (size_t i = 0; i < command.size(); ++i) {
    if (!std::isfinite(command[i]))
      fail(fmt::format("number {} of its {} is {}", i, layout_.command, command[i]));
  }
  if (layout_.has_gripper && !std::isfinite(action[layout_.gripper_action]))
    fail(fmt::format("its gripper is {}", action[layout_.gripper_action]));
  if (mode_ == ControlMode::kCartesianTquat && !HasDirection(command.subspan(3)))
    fail(
        "the quaternion of its tquat is zero, which is no rotation; [0, 0, 0, 1] (xyzw) turns "
        "nothing");
}

Pose ArmDriver::NextPose(std::span<const double> command) const {
  const Pose given = PoseOfAction(mode_, command);
  if (relative_to_ == RelativeTo::kNone) return LimitedStep(sent_, given, limit_);
  const Pose& from = relative_to_ == RelativeTo::kLastStep ? sent_ : origin_;
  return LimitedStep(sent_, MovedBy(from, given), limit_);
}

std::vector<double> ArmDriver::NextJoints(std::span<const double> command) const {
  std::vector<double> q = PositionsOf(command);
  if (relative_to_ != RelativeTo::kNone) {
    const auto& from = relative_to_ == RelativeTo::kLastStep ? sent_joints_ : origin_joints_;
    for (size_t i = 0; i < q.size(); ++i) q[i] += from[i];
  }
  LimitJointStep(sent_joints_, limit_.rotation, q);
  for (size_t i = 0; i < q.size(); ++i)
    q[i] = std::clamp(q[i], joint_limits_[i].lower, joint_limits_[i].upper);
  return q;
}

double ArmDriver::Opening(double value) const {
  return binary_gripper_ ? (value >= 0.5 ? 1 : 0) : std::clamp(value, 0.0, 1.0);
}

void ArmDriver::SendGripper(double value, RobotAction& own) {
  const double opening = Opening(value);
  if (opening != sent_opening_) {
    gripper_still_ = false;
    window_start_ = robot_.scene().time();
    window_opening_ = gripper()->opening();
  }
  sent_opening_ = opening;
  const GroupCommand command = GroupCommand::Opening(opening);
  if (gripper_->name() == robot_.name()) {
    own[gripper()->name()] = command;
  } else {
    gripper_->Apply({{gripper()->name(), command}});
  }
}

bool ArmDriver::Send(std::span<const double> action) {
  RobotAction commands;
  const std::span<const double> own = PartOf(action, layout_.action);
  const std::string& arm = robot_.arm().name();
  if (gripper_) SendGripper(action[layout_.gripper_action], commands);
  if (mode_ == ControlMode::kJoints) {
    sent_joints_ = NextJoints(own);
    commands[arm] = GroupCommand::Joints(sent_joints_);
    return robot_.Apply(commands).ok;
  }
  const Pose next = NextPose(own);
  commands[arm] = GroupCommand::LeafPose(base_in_shared_.inverse() * next);
  if (!robot_.Apply(commands).ok) return false;
  sent_ = next;
  return true;
}

bool ArmDriver::GripperIsStill(double time) {
  if (gripper_still_ || time - window_start_ < kWindow) return gripper_still_;
  const double opening = gripper()->opening();
  gripper_still_ = std::abs(opening - window_opening_) < kStill;
  window_start_ = time;
  window_opening_ = opening;
  return gripper_still_;
}

bool ArmDriver::HasArrived(double time) {
  const std::span<const double> wanted =
      robot_.controller(robot_.arm().name()).commanded_joint_pos();
  const std::span<const double> is = robot_.jnt_pos_msr(), moves = robot_.jnt_vel_msr();
  for (size_t i = 0; i < wanted.size(); ++i) {
    if (std::abs(is[i] - wanted[i]) > tolerance_) return false;
    if (std::abs(moves[i]) * kSettling > tolerance_) return false;
  }
  return !gripper_ || GripperIsStill(time);
}

void ArmDriver::Observe(std::span<double> observation) const {
  const Pose tcp = robot_.scene().shared_base_frame_to_world().inverse() * robot_.tcp_in_world();
  double* tquat = observation.data() + layout_.tquat.begin;
  std::copy_n(tcp.translation().data(), 3, tquat);
  std::copy_n(tcp.quaternion().data(), 4, tquat + 3);
  const std::array<double, 6> xyzrpy = tcp.xyzrpy();
  std::copy(xyzrpy.begin(), xyzrpy.end(), observation.begin() + layout_.xyzrpy.begin);
  robot_.arm().GetJointPos(observation.subspan(layout_.joints.begin, layout_.joints.size));
  if (layout_.has_gripper)
    observation[layout_.gripper] =
        binary_gripper_ ? sent_opening_ : std::clamp(gripper()->opening(), 0.0, 1.0);
}

}  // namespace robocell
