#include "robocell/env/arm_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/env/base_frame.h"
#include "robocell/env/env_scene.h"
#include "robocell/env/mounted_gripper.h"
#include "robocell/kinematics/ik_step.h"
#include "robocell/math/rotation.h"
#include "robocell/robot/arm_group.h"
#include "robocell/robot/arrival.h"
#include "robocell/robot/controller.h"

namespace robocell::internal {
namespace {

// In Cartesian modes joints may lead by this many times as much as poses, for a small displacement
// of the TCP can be a large one of a joint.
constexpr double kJointsOfPose = 3;
// An absolute pose without a solution nearby is out of reach, unless its distance is within these,
// m and rad.
constexpr double kSmallShift = 0.1, kSmallTurn = 0.5;
// A rotation that an arm of fewer than six joints reaches; the tolerance of inverse kinematics is
// smaller.
constexpr double kSameRotation = 1e-4;

std::optional<Robot> RobotWithGripper(const EnvConfig& config, const Robot& robot) {
  if (CarriesMountedGripper(config, robot))
    return Robot::Of(robot.scene(), MountedGripperName(robot.name()));
  return robot.has_gripper() ? std::optional<Robot>(robot) : std::nullopt;
}

std::span<const double> PartOf(std::span<const double> vector, const VectorPart& part) {
  return vector.subspan(part.begin, part.size);
}

std::vector<double> PositionsOf(std::span<const double> values) {
  return {values.begin(), values.end()};
}

bool IsSmallStep(const Pose& from, const Pose& to) {
  return (to.translation() - from.translation()).norm() <= kSmallShift &&
         AngleBetween(from.quaternion(), to.quaternion()) <= kSmallTurn;
}

bool AreFinite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

bool IsNoMotion(const Pose& delta) { return delta.translation().isZero(0) && delta.angle() == 0; }

// Removes a command from an action and returns it, if there is one.
std::optional<GroupCommand> TakeCommand(Action& action, const std::string& robot,
                                        const std::string& group) {
  const auto of_robot = action.find(robot);
  if (of_robot == action.end()) return std::nullopt;
  const auto found = of_robot->second.find(group);
  if (found == of_robot->second.end()) return std::nullopt;
  std::optional<GroupCommand> command = std::move(found->second);
  of_robot->second.erase(found);
  return command;
}

// Steps are found to be without solution, and to be over, by the joint positions that are sent.
void RequireJointPositions(const EnvConfig& config, const Robot& robot) {
  const Controller& controller = robot.controller(robot.arm().name());
  const TargetKind kind = controller.target_kind();
  if (kind == TargetKind::kJointPositions || kind == TargetKind::kJointSteps) return;
  throw ArgumentError(fmt::format(
      "environment '{}' / robot '{}': its controller '{}' takes {}, but an environment sends joint "
      "positions, found by inverse kinematics where actions are poses. Write `control: {{{}: "
      "joint_position}}`, joint_impedance or relative_joint_position at the top level of the robot "
      "file, or leave it out",
      config.name, robot.name(), controller.kind(), Describe(kind), robot.arm().name()));
}

std::vector<bool> TurnFreely(const Robot& robot) {
  std::vector<bool> free;
  for (const Interval& limit : robot.joint_limits())
    free.push_back(!std::isfinite(limit.lower) || !std::isfinite(limit.upper));
  return free;
}

}  // namespace

void PutMemory(const ArmMemory& memory, std::vector<double>& out) {
  out.push_back(static_cast<double>(memory.commanded.size()));
  for (const Pose* pose : {&memory.sent, &memory.origin, &memory.seen}) {
    out.resize(out.size() + 7);
    PutTquat(*pose, std::span(out).last(7));
  }
  for (const std::vector<double>* q :
       {&memory.sent_joints, &memory.origin_joints, &memory.commanded, &memory.pending_joints,
        &memory.seen_joints})
    out.insert(out.end(), q->begin(), q->end());
  const FingerMemory& fingers = memory.fingers;
  out.insert(out.end(),
             {memory.sent_opening, memory.commanded_opening, fingers.is_still ? 1.0 : 0.0,
              fingers.window_start, fingers.still_windows});
  for (const std::array<double, 3>* move : {&memory.pending.shift, &memory.pending.turn})
    out.insert(out.end(), move->begin(), move->end());
  PutList(fingers.window, out);
}

ArmMemory ReadArmMemory(NumberReader& reader) {
  const size_t joints = reader.Count();
  const auto pose = [&] {
    const std::span<const double> p = reader.Take(7);
    return Pose({p[0], p[1], p[2]}, Quaternion{p[3], p[4], p[5], p[6]});
  };
  ArmMemory memory;
  memory.sent = pose();
  memory.origin = pose();
  memory.seen = pose();
  for (std::vector<double>* q : {&memory.sent_joints, &memory.origin_joints, &memory.commanded,
                                 &memory.pending_joints, &memory.seen_joints})
    *q = PositionsOf(reader.Take(joints));
  const std::span<const double> rest = reader.Take(5);
  memory.sent_opening = rest[0];
  memory.commanded_opening = rest[1];
  memory.fingers.is_still = rest[2] != 0;
  memory.fingers.window_start = rest[3];
  memory.fingers.still_windows = rest[4];
  for (std::array<double, 3>* move : {&memory.pending.shift, &memory.pending.turn})
    std::ranges::copy(reader.Take(3), move->begin());
  memory.fingers.window = reader.List();
  return memory;
}

ArmDriver::ArmDriver(const EnvConfig& config, Robot robot, RobotLayout layout)
    : mode_(config.control_mode),
      relative_to_(config.relative_to),
      limit_(config.step_limit()),
      lead_(config.target_lead()),
      binary_gripper_(config.wrappers.binary_gripper),
      robot_(std::move(robot)),
      task_space_(TaskSpaceOf(robot_)),
      watch_(ArrivalTolerances(robot_, robot_.arm().name()), robot_.scene().timestep(),
             LargestDelay(robot_, robot_.arm().name())),
      still_(watch_.tolerances().size()),
      pos_(still_),
      vel_(still_),
      gravity_(still_),
      resistance_(still_),
      rest_(still_),
      steady_(still_),
      gripper_(RobotWithGripper(config, robot_)),
      layout_(std::move(layout)),
      joint_limits_(CommandLimits(robot_)),
      turns_freely_(TurnFreely(robot_)),
      base_moves_(BaseTravel(robot_).has_value()),
      fixed_base_(BaseInSharedFrame(robot_)) {
  if (gripper_) fingers_.emplace(*gripper_);
  RequireJointPositions(config, robot_);
  for (const ChainJoint& joint : robot_.chain().joints()) {
    const bool own_default = config.max_target_lead.empty() && joint.type == ChainJointType::kSlide;
    if (mode_ == ControlMode::kJoints) {
      joint_lead_.push_back(own_default ? lead_.translation : lead_.rotation);
    } else {
      const bool slide = joint.type == ChainJointType::kSlide;
      joint_lead_.push_back(kJointsOfPose * (slide ? lead_.translation : lead_.rotation));
    }
  }
}

std::vector<Robot> ArmDriver::robots() const {
  std::vector<Robot> robots = {robot_};
  if (gripper_ && gripper_->name() != robot_.name()) robots.push_back(*gripper_);
  return robots;
}

void ArmDriver::Reset() {
  controller_ = robot_.shared_controller(robot_.arm().name());
  fixed_base_ = BaseInSharedFrame(robot_);
  memory_.sent_joints = PositionsOf(controller_->commanded_joint_pos());
  memory_.sent = base_in_shared() * robot_.FkFrame(memory_.sent_joints);
  if (gripper_) memory_.sent_opening = gripper_->controller(gripper()->name()).target()[0];
  if (fingers_) fingers_->Begin(robot_.scene().time());
  memory_.pending = {};
  memory_.pending_joints.assign(memory_.sent_joints.size(), 0);
  memory_.seen_joints = robot_.arm().joint_pos();
  const bool at_rest = memory_.seen_joints == memory_.sent_joints;  // at most starts it is
  memory_.seen = at_rest ? memory_.sent : TcpAt(memory_.seen_joints);
  WatchFromNow();
  SetOriginToCurrent();
}

void ArmDriver::SetOriginToCurrent() {
  memory_.origin = memory_.sent;
  memory_.origin_joints = memory_.sent_joints;
}

Pose ArmDriver::base_in_shared() const {
  return base_moves_ ? BaseInSharedFrame(robot_) : fixed_base_;
}

ArmMemory ArmDriver::memory() const {
  ArmMemory memory = memory_;
  if (fingers_) memory.fingers = fingers_->memory();
  memory.commanded = PositionsOf(robot_.controller(robot_.arm().name()).commanded_joint_pos());
  if (gripper_) memory.commanded_opening = gripper_->controller(gripper()->name()).target()[0];
  return memory;
}

void ArmDriver::Recall(const ArmMemory& memory) {
  memory_ = memory;
  if (fingers_) fingers_->Recall(memory.fingers);
  controller_ = robot_.shared_controller(robot_.arm().name());
  sent_ = {};
  WatchFromNow();
  DriveTo(memory.commanded);
  if (gripper_)
    gripper_->Apply({{gripper()->name(), GroupCommand::Opening(memory.commanded_opening)}});
}

// The drive goes to the nearest value inside anyway, and later actions start from there.
std::vector<double> ArmDriver::InsideLimits(std::span<const double> joints) {
  std::vector<double> inside = PositionsOf(joints);
  const std::span<const ChainJoint> chain = robot_.chain().joints();
  for (size_t i = 0; i < inside.size(); ++i) {
    const Interval range{chain[i].lower, chain[i].upper};
    inside[i] = beyond_.Clamp(inside[i], range, [&] {
      return fmt::format("robot '{}' / group '{}': joint '{}'", robot_.name(), robot_.arm().name(),
                         chain[i].name);
    });
  }
  return inside;
}

void ArmDriver::DriveTo(std::span<const double> joints) {
  robot_.Apply({{robot_.arm().name(), GroupCommand::Joints(PositionsOf(joints))}});
  // A controller that adds steps computed its target as a sum.
  std::ranges::copy(joints, controller_->command_port().begin());
}

void ArmDriver::RequireAction(std::span<const double> action, const std::string& place) const {
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
  if (mode_ == ControlMode::kCartesianTquat && relative_to_ == RelativeTo::kNone &&
      !HasDirection(command.subspan(3)))
    fail(
        "the quaternion of its tquat is zero, which is not a rotation; for none write [0, 0, 0, 1] "
        "(xyzw)");
}

Pose ArmDriver::NextPose(const Pose& last, const Pose& given) const {
  if (relative_to_ == RelativeTo::kNone) return LimitedStep(last, given, limit_);
  const Pose& from = relative_to_ == RelativeTo::kLastStep ? last : memory_.origin;
  return LimitedStep(last, MovedBy(from, given), limit_);
}

double ArmDriver::Opening(double value) const {
  return binary_gripper_ ? (value >= 0.5 ? 1 : 0) : std::clamp(value, 0.0, 1.0);
}

void ArmDriver::SendGripper(double opening, RobotAction& own) {
  if (opening != memory_.sent_opening) fingers_->Begin(robot_.scene().time());
  memory_.sent_opening = opening;
  const GroupCommand command = GroupCommand::Opening(opening);
  if (gripper_->name() == robot_.name()) {
    own[gripper()->name()] = command;
  } else {
    gripper_->Apply({{gripper()->name(), command}});
  }
}

bool ArmDriver::GetSteadyTarget(std::span<const double> q, std::span<const double> v,
                                std::span<double> out) const {
  const auto* arm = dynamic_cast<const ArmGroup*>(&robot_.arm());
  if (!controller_ || !arm || !arm->has_chain()) return false;
  arm->GravityTorques(q, gravity_);
  std::fill(resistance_.begin(), resistance_.end(), 0);
  arm->AddResistance(q, v, resistance_);
  return controller_->GetSteadyTarget(q, v, gravity_, resistance_, out);
}

bool ArmDriver::GetPresentTargets() const {
  robot_.arm().GetJointPos(pos_);
  robot_.arm().GetJointVel(vel_);
  if (!AreFinite(pos_)) return false;
  if (!GetSteadyTarget(pos_, still_, rest_)) rest_ = pos_;
  if (!GetSteadyTarget(pos_, vel_, steady_)) steady_ = rest_;
  return true;
}

Pose ArmDriver::LastPose(const Pose& sent, const PendingMove& move, PendingMove& pending,
                         Pose& seen) const {
  const Led<Pose> led = {seen, TcpAt(pos_), TcpAt(rest_), TcpAt(steady_)};
  seen = led.present;
  return WithinLead(sent, led, lead_, pending, move);
}

std::vector<double> ArmDriver::LastJoints(std::span<const double> move,
                                          std::vector<double>& pending,
                                          std::vector<double>& seen) const {
  std::vector<double> last = memory_.sent_joints;
  for (size_t i = 0; i < last.size(); ++i) {
    const Led<double> led = {seen[i], pos_[i], rest_[i], steady_[i]};
    last[i] = WithinJointLead(last[i], led, joint_lead_[i], pending[i], move[i]);
  }
  seen = pos_;
  return last;
}

bool ArmDriver::BoundJoints(std::vector<double>& joints, std::vector<double>& pending,
                            std::vector<double>& seen) const {
  std::vector<Led<double>> led;
  for (size_t i = 0; i < joints.size(); ++i)
    led.push_back({seen[i], pos_[i], rest_[i], steady_[i]});
  seen = pos_;
  return TakeBackJoints(joints, led, joint_lead_, pending);
}

bool ArmDriver::SendJoints(std::span<const double> command, RobotAction& commands) {
  std::vector<double> q = PositionsOf(command), pending = memory_.pending_joints,
                      seen = memory_.seen_joints;
  std::vector<double> last = memory_.sent_joints, move(q.size());
  for (size_t i = 0; i < q.size(); ++i) {
    const double wanted = relative_to_ == RelativeTo::kLastStep ? last[i] + q[i]
                          : relative_to_ == RelativeTo::kConfiguredOrigin
                              ? memory_.origin_joints[i] + q[i]
                              : q[i];
    move[i] = std::clamp(wanted - last[i], -limit_.rotation, limit_.rotation);
  }
  if (GetPresentTargets()) last = LastJoints(move, pending, seen);
  for (size_t i = 0; i < q.size(); ++i) {
    if (relative_to_ == RelativeTo::kLastStep) {
      if (q[i] == 0) {  // keeps its target
        last[i] = memory_.sent_joints[i];
        pending[i] = memory_.pending_joints[i];
        seen[i] = memory_.seen_joints[i];
      }
      q[i] += last[i];
    } else if (relative_to_ == RelativeTo::kConfiguredOrigin) {
      q[i] += memory_.origin_joints[i];
    }
  }
  LimitJointStep(last, limit_.rotation, q);
  for (size_t i = 0; i < q.size(); ++i) {
    q[i] = std::clamp(q[i], joint_limits_[i].lower, joint_limits_[i].upper);
    pending[i] += q[i] - last[i];
  }
  for (size_t i = 0; i < q.size(); ++i)
    sent_.joint_taken_back =
        std::max(sent_.joint_taken_back, std::abs(memory_.sent_joints[i] - last[i]));
  memory_.pending_joints = std::move(pending);
  memory_.seen_joints = std::move(seen);
  memory_.sent_joints = q;
  commands[robot_.arm().name()] = GroupCommand::Joints(std::move(q));
  return robot_.Apply(commands).ok;
}

bool ArmDriver::SendPose(std::span<const double> command, RobotAction& commands) {
  const std::string& arm = robot_.arm().name();
  const Pose given = PoseOfAction(mode_, command);
  const bool keeps = relative_to_ == RelativeTo::kLastStep && IsNoMotion(given);
  PendingMove pending = memory_.pending;
  std::vector<double> joints = PositionsOf(controller_->commanded_joint_pos()),
                      pending_joints = memory_.pending_joints, seen_joints = memory_.seen_joints;
  Pose seen = memory_.seen, last = memory_.sent;
  bool bounded = false;
  if (!keeps && GetPresentTargets()) {
    PendingMove move;
    AddMove(move, last, NextPose(last, given));
    bounded = BoundJoints(joints, pending_joints, seen_joints);
    if (bounded) {
      last = TcpAt(joints);
      AddMove(pending, memory_.sent, last);
    }
    last = LastPose(last, move, pending, seen);
  }
  Pose next = keeps ? last : NextPose(last, given);
  const Pose target = base_in_shared().inverse() * next;
  bool solved = false;
  if (bounded) {
    const IkResult ik = task_space_.Step(robot_.chain(), target, joints);
    solved = ik.success;
    if (solved) commands[arm] = GroupCommand::Joints(PositionsOf(ik.q));
  } else {
    commands[arm] = GroupCommand::LeafPose(target);
  }
  // The gripper's command is carried out even if the pose has no solution.
  solved = robot_.Apply(commands).ok && (solved || !bounded);
  if (solved && task_space_.is_partial(robot_.chain())) {
    const Pose reached = TcpAt(controller_->commanded_joint_pos());
    const Pose wanted = task_space_.Nearest(next, reached);
    const double rotation = AngleBetween(reached.quaternion(), wanted.quaternion());
    if (rotation > kSameRotation) {
      sent_.position_shortfall = (reached.translation() - wanted.translation()).norm();
      sent_.rotation_shortfall = rotation;
    }
    if (rotation > kSameRotation || task_space_.is_part()) next = reached;
  }
  if (!solved) {
    const Pose now = robot_.FkFrame(joints), wanted = task_space_.Nearest(target, now);
    const bool small = relative_to_ == RelativeTo::kLastStep || IsSmallStep(now, wanted);
    if (!small) return false;
    const IkResult near = IkTowards(robot_.chain(), wanted, joints);
    if (!near.success) return false;
    sent_.position_shortfall = near.position_error;
    sent_.rotation_shortfall = near.rotation_error;
    next = base_in_shared() * robot_.FkFrame(near.q);
    robot_.Apply({{arm, GroupCommand::Joints(PositionsOf(near.q))}});
  }
  sent_.position_taken_back = (memory_.sent.translation() - last.translation()).norm();
  sent_.rotation_taken_back = AngleBetween(memory_.sent.quaternion(), last.quaternion());
  AddMove(pending, last, next);
  const std::span<const double> driven = controller_->commanded_joint_pos();
  for (size_t i = 0; i < joints.size(); ++i) pending_joints[i] += driven[i] - joints[i];
  memory_.pending_joints = std::move(pending_joints);
  memory_.seen_joints = std::move(seen_joints);
  memory_.pending = pending;
  memory_.seen = seen;
  memory_.sent = next;
  return true;
}

bool ArmDriver::Send(std::span<const double> action) {
  RobotAction commands;
  const std::span<const double> own = PartOf(action, layout_.action);
  controller_ = robot_.shared_controller(robot_.arm().name());
  sent_ = {};
  WatchFromNow();
  if (gripper_) SendGripper(Opening(action[layout_.gripper_action]), commands);
  return mode_ == ControlMode::kJoints ? SendJoints(own, commands) : SendPose(own, commands);
}

bool ArmDriver::SendOwn(Action& action) {
  controller_ = robot_.shared_controller(robot_.arm().name());
  sent_ = {};
  WatchFromNow();
  if (gripper_) {
    if (const auto opening = TakeCommand(action, gripper_->name(), gripper()->name())) {
      RobotAction own;
      SendGripper(opening->values.at(0), own);
      if (!own.empty()) gripper_->Apply(own);
    }
  }
  const auto command = TakeCommand(action, robot_.name(), robot_.arm().name());
  if (!command) return true;
  const std::vector<double> before = PositionsOf(controller_->commanded_joint_pos());
  if (command->kind == GroupCommand::kJoints)
    DriveTo(InsideLimits(command->values));
  else if (!robot_.Apply({{robot_.arm().name(), *command}}).ok)
    return false;
  // The next action starts from these targets.
  const std::span<const double> driven = controller_->commanded_joint_pos();
  for (size_t i = 0; i < before.size(); ++i) memory_.pending_joints[i] += driven[i] - before[i];
  memory_.sent_joints = PositionsOf(driven);
  const Pose next = TcpAt(driven);
  AddMove(memory_.pending, memory_.sent, next);
  memory_.sent = next;
  return true;
}

void ArmDriver::WatchFromNow() {
  robot_.arm().GetJointPos(pos_);
  watch_.Begin(pos_, robot_.scene().time());
}

void ArmDriver::Watch(double time) {
  robot_.arm().GetJointPos(pos_);
  watch_.Look(pos_, controller_->commanded_joint_pos(), time);
}

// Returns true if some joint cannot get within its tolerance, because its servo gives way to
// gravity, and all joints are where they come to rest.
bool ArmDriver::IsHeldAwayByGravity() {
  if (!GetSteadyTarget(watch_.pos(), still_, steady_)) return false;
  const std::vector<double>& tolerances = watch_.tolerances();
  if (!AreWithin(steady_, controller_->commanded_joint_pos(), tolerances)) return false;
  return !AreWithin(steady_, watch_.pos(), tolerances);
}

ArmStatus ArmDriver::Status(double time) {
  const bool near = watch_.IsNear(controller_->commanded_joint_pos());
  const bool slow = watch_.is_slow();
  ArmStatus status = ArmStatus::kMoving;
  if (near && slow) {
    status = ArmStatus::kArrived;
  } else if (watch_.at_rest() || (slow && IsHeldAwayByGravity())) {
    status = ArmStatus::kSettled;
  }
  if (!gripper_) return status;
  if (!fingers_->IsStill(time, memory_.sent_opening)) return ArmStatus::kMoving;
  if (status == ArmStatus::kArrived && !fingers_->IsWhereItEnds(memory_.sent_opening))
    status = ArmStatus::kSettled;
  return status;
}

ArmMotion ArmDriver::motion() const {
  ArmMotion motion = sent_;
  const std::span<const double> pos = watch_.pos();
  const std::span<const double> wanted = controller_->commanded_joint_pos();
  Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxChainJoints> jacobian(
      6, static_cast<Eigen::Index>(pos.size()));
  const Pose tcp = robot_.chain().Jacobian(pos, jacobian), sent = robot_.FkFrame(wanted);
  motion.position_error = (sent.translation() - tcp.translation()).norm();
  motion.rotation_error = AngleBetween(sent.quaternion(), tcp.quaternion());
  Eigen::Vector<double, 6> twist = Eigen::Vector<double, 6>::Zero();
  for (size_t i = 0; i < pos.size(); ++i) {
    const double speed = watch_.Velocity(i);
    twist += jacobian.col(static_cast<Eigen::Index>(i)) * speed;
    motion.joint_error = std::max(motion.joint_error, std::abs(pos[i] - wanted[i]));
    motion.joint_speed = std::max(motion.joint_speed, std::abs(speed));
  }
  motion.linear_speed = twist.head<3>().norm();
  motion.angular_speed = twist.tail<3>().norm();
  return motion;
}

void ArmDriver::Observe(std::span<double> observation) const {
  const Pose tcp = robot_.scene().shared_base_frame_to_world().inverse() * robot_.tcp_in_world();
  ObserveTquat(tcp, observation.subspan(layout_.tquat.begin, layout_.tquat.size));
  const std::array<double, 6> xyzrpy = tcp.xyzrpy();
  std::copy(xyzrpy.begin(), xyzrpy.end(), observation.begin() + layout_.xyzrpy.begin);
  const std::span<double> joints = observation.subspan(layout_.joints.begin, layout_.joints.size);
  robot_.arm().GetJointPos(joints);
  for (size_t i = 0; i < joints.size(); ++i) {
    if (turns_freely_[i]) joints[i] = ObservedTurn(joints[i], joint_limits_[i].upper + kJointSlack);
  }
  if (layout_.has_gripper)
    observation[layout_.gripper] = binary_gripper_ ? Opening(memory_.sent_opening)
                                                   : std::clamp(gripper()->opening(), 0.0, 1.0);
}

}  // namespace robocell::internal
