#include "robocell/hardware/simulated_arm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/mujoco/step.h"
#include "robocell/robot/arm_group.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/move_group.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/ctrl_mode.h"

namespace robocell {
namespace {

constexpr double kVelocity = 2, kAcceleration = 10;
constexpr double kLongestGap = 0.5;  // s: a program that slept is not caught up with

bool HasTorques(const Robot& robot) {
  try {
    (void)robot.drive(robot.arm().name(), CtrlMode::kTorque);
    return true;
  } catch (const ArgumentError&) {
    return false;
  }
}

}  // namespace

ArmLimits LimitsOf(const Robot& robot) {
  ArmLimits limits;
  const MoveGroup& arm = robot.arm();
  const auto* servos = dynamic_cast<const ArmGroup*>(&arm);
  for (const Interval& range : robot.joint_limits()) {
    limits.lower.push_back(range.lower);
    limits.upper.push_back(range.upper);
  }
  const size_t n = limits.lower.size();
  limits.velocity.assign(n, kVelocity);
  limits.acceleration.assign(n, kAcceleration);
  limits.force.assign(n, std::numeric_limits<double>::infinity());
  for (size_t i = 0; servos && i < n; ++i) {
    const Interval force = servos->torque_limit(i);
    const double most = std::max(std::abs(force.lower), std::abs(force.upper));
    if (most > 0) limits.force[i] = most * (1 + 1e-9);  // a motor at its limit is no fault
  }
  return limits;
}

SimulatedArm::SimulatedArm(Robot robot, const SimulatedArmOptions& options)
    : robot_(std::move(robot)),
      scene_(robot_.scene()),
      options_(options),
      rng_(Rng::Stream(options.seed, "noise of an arm", robot_.name())) {
  if (!(options.noise >= 0) || !std::isfinite(options.noise) || !(options.watchdog > 0)) {
    throw ArgumentError(
        fmt::format("{}: noise is {} and watchdog {}; expected finite noise of at least 0 and a "
                    "watchdog above 0",
                    name(), options.noise, options.watchdog));
  }
  limits_ = Narrowed(LimitsOf(robot_), options.limits, joint_names(), name());
  robot_.set_ctrl_mode(CtrlMode::kPosition);
  takes_forces_ = HasTorques(robot_);
  gripper_ = robot_.gripper_of(robot_.arm().name());
  began_ = ArmPort::now() - scene_.time();
  commanded_ = scene_.time();
  robot_.Update();
}

std::string SimulatedArm::name() const { return "simulated " + robot_.name(); }

std::vector<std::string> SimulatedArm::joint_names() const {
  std::vector<std::string> names;
  for (const std::string& joint : robot_.joint_names()) names.push_back(robot_.OwnName(joint));
  return names;
}

double SimulatedArm::now() const {
  return options_.real_time ? ArmPort::now() - began_ : scene_.time();
}

void SimulatedArm::Advance(double time) {
  if (time - scene_.time() > kLongestGap) {  // real time only
    began_ += time - scene_.time() - kLongestGap;
    time = scene_.time() + kLongestGap;
  }
  // Half a step: the scene's clock is a sum of steps, which rounding must not make one more.
  while (scene_.time() + scene_.timestep() / 2 < time) {
    if (scene_.time() - commanded_ > options_.watchdog) Hold();
    robot_.Update();
    const StepResult step = scene_.Step();
    if (!step.ok()) throw Error(fmt::format("{}: {}", name(), step.message));
    if (step.steps == 0) return;  // a viewer holds it
  }
}

void SimulatedArm::WaitUntil(double time) {
  if (options_.real_time) {
    ArmPort::WaitUntil(time);
  } else {
    Advance(time);
  }
}

bool SimulatedArm::Read(ArmMeasurement& out) {
  if (options_.real_time) Advance(now());
  if (scene_.time() == read_) return false;
  read_ = scene_.time();
  robot_.Update();
  out.time = read_;
  const auto copy = [](auto from, std::vector<double>& to) { to.assign(from.begin(), from.end()); };
  copy(robot_.jnt_pos_msr(), out.pos);
  copy(robot_.jnt_vel_msr(), out.vel);
  copy(robot_.jnt_trq_msr(), out.force);
  for (double& p : out.pos) p += options_.noise * rng_.Normal();
  out.opening = kNoOpening;
  if (!gripper_.empty())
    out.opening = dynamic_cast<const GripperGroup&>(robot_.group(gripper_)).opening();
  return true;
}

void SimulatedArm::Send(const ArmCommand& command) {
  if (command.force.empty()) {
    robot_.set_ctrl_mode(CtrlMode::kPosition);
    robot_.SetJntPosCmd(command.pos);
  } else {
    robot_.set_ctrl_mode(CtrlMode::kTorque);
    robot_.SetJntTrqCmd(command.force);
  }
  if (!gripper_.empty() && std::isfinite(command.opening)) {
    const double opening = std::clamp(command.opening, 0.0, 1.0);
    robot_.controller(gripper_).SetTarget({&opening, 1});
  }
  commanded_ = scene_.time();
  holds_ = false;
}

void SimulatedArm::Hold() {
  if (holds_) return;
  holds_ = true;
  robot_.set_ctrl_mode(CtrlMode::kPosition);
  robot_.SetJntPosCmd(robot_.jnt_pos_msr());
}

}  // namespace robocell
