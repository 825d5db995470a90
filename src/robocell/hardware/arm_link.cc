#include "robocell/hardware/arm_link.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/hardware/safety_gate.h"
#include "robocell/hardware/simulated_arm.h"
#include "robocell/mujoco/step.h"
#include "robocell/robot/arm_group.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/move_group.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/step_gate.h"
#include "robocell/spec/ctrl_mode.h"

namespace robocell {
namespace {

constexpr double kArrived = 0.01;        // rad or m
constexpr double kLongestYield = 1;      // s, beyond braking
constexpr double kBetweenReads = 0.002;  // s

std::string ArmName(const Robot& robot, const std::string& group) {
  const std::string name = group.empty() ? robot.arm().name() : group;
  (void)robot.gripper_of(name);  // throws for a group that is no arm
  return name;
}

ArmGroup& ArmOf(const Robot& robot, const std::string& group) {
  auto* arm = dynamic_cast<ArmGroup*>(&robot.group(group));
  if (arm) return *arm;
  throw ArgumentError(fmt::format("{}: an arm's link needs an arm of robocell's own kind",
                                  robot.group(group).place()));
}

// Returns how many steps of the scene a period has.
int StepsOf(const Scene& scene, double period) {
  if (!(period > 0) || !std::isfinite(period))
    throw ArgumentError(fmt::format("period is {}; expected seconds above 0", period));
  return std::max(1, static_cast<int>(std::ceil(period / scene.timestep() - 1e-9)));
}

}  // namespace

class ArmLink::Impl final : public internal::StepLink {
 public:
  Impl(Robot of, std::shared_ptr<ArmPort> port_of, const ArmLinkOptions& options)
      : robot(std::move(of)),
        scene(robot.scene()),
        port(std::move(port_of)),
        group(ArmName(robot, options.group)),
        gripper(robot.gripper_of(group)),
        steps(StepsOf(scene, options.period)),
        period(steps * scene.timestep()),
        place(fmt::format("arm '{}' of robot '{}' ({})", group, robot.name(), port->name())),
        gate(CheckedJoints(), port->limits(), options.safety, period, place),
        timeout_(options.timeout),
        dry_run_(options.safety.dry_run) {
    if (!gripper.empty()) {
      saved_.resize(static_cast<size_t>(Gripper().nu()));
      follow_ = saved_;
      Gripper().CtrlForOpening(1, follow_);  // measures the gripper, which takes a while
    }
    (void)robot.controller(group);  // throws with the reason for an arm that nothing drives
    WaitForArm();
    WriteMeasured();
    scene.Forward();
    robot.controller(group).Reset();
    robot.Update();
  }
  // False once the link was closed: then it does nothing.
  bool is_tied() const { return tied_; }
  // Brakes an arm that moves, and holds it.
  void Untie() {
    if (tied_) {
      HearStop();
      if (!stopped_ && !dry_run_ && !gate.is_at_rest()) {
        gate.Stop("its link was closed");
        ComeToRest();
      }
    }
    Hold();
    tied_ = false;
  }

  // --- StepGate ---------------------------------------------------------------------------------
  Answer BeforeStep() override {
    if (!tied_) return kGo;
    if (stopped_) return kStop;
    HearOthers();
    if (at_step_ == 0) Exchange();
    if (gate.state() == ArmState::kStopped) {
      ComeToRest();
      return kStop;
    }
    at_step_ = (at_step_ + 1) % steps;
    FollowOpening();
    return kGo;
  }
  void EndStep() noexcept override {
    if (!follows_) return;
    follows_ = false;
    try {
      Gripper().SetCtrl(saved_);
    } catch (const std::exception& error) {
      LogWarn(fmt::format("{}: {}", place, error.what()));
    }
  }
  void AfterStep() override {
    if (tied_) WriteMeasured();
  }
  std::string StopReason() const override { return gate.reason(); }
  void OnClose() override { Untie(); }

  // The two that any thread may call.
  void Renew() { renewed_ = true; }
  void AskToStop(const std::string& reason) {
    const std::lock_guard lock(mutex_);
    if (!asked_to_stop_) why_ = reason;
    asked_to_stop_ = true;
  }
  bool is_asked_to_stop() const { return asked_to_stop_; }

  // Writes the measured joints into the simulation.
  void WriteMeasured() {
    ArmGroup& arm = ArmOf(robot, group);
    arm.WriteJointPos(gate.measured().pos);
    arm.SetJointVel(gate.measured().vel);
  }

  // Holds the arm, once.
  void Hold() noexcept {
    if (std::exchange(held_, true) || dry_run_) return;
    try {
      port->Hold();
    } catch (const std::exception& error) {
      LogWarn(fmt::format("{}: does not take the command to hold: {}", place, error.what()));
    }
  }

  Robot robot;
  Scene scene;
  std::shared_ptr<ArmPort> port;
  std::string group, gripper;
  int steps;  // of the scene, in a period
  // Seconds between two commands, by which the gate computes: it stays when the scene's timestep
  // changes.
  double period;
  std::string place;
  SafetyGate gate;
  int hook = -1;

 private:
  GripperGroup& Gripper() const { return dynamic_cast<GripperGroup&>(robot.group(gripper)); }

  std::vector<std::string> CheckedJoints() const {
    std::vector<std::string> own;
    for (const std::string& joint : robot.group(group).joint_names())
      own.push_back(robot.OwnName(joint));
    const std::vector<std::string> theirs = port->joint_names();
    if (own == theirs) return own;
    throw ArgumentError(fmt::format("{} has the joints {}; the robot's arm has {}, in this order",
                                    port->name(), ListNames(theirs), ListNames(own)));
  }

  void WaitForArm() {
    const double begin = port->now();
    (void)port->Read(read_);  // what a port has kept until now may be old
    while (!(port->Read(read_) && gate.Accept(read_, port->now()))) {
      if (!(port->now() - begin <= timeout_)) {
        throw IoError(fmt::format("{}: nothing good was measured within {} s ({} damaged)", place,
                                  timeout_, gate.counts().damaged));
      }
      port->WaitUntil(port->now() + kBetweenReads);
    }
    due_ = port->now();
  }

  void HearOthers() {
    if (renewed_.exchange(false)) gate.Renew(port->now());
    HearStop();
  }
  void HearStop() {
    if (!asked_to_stop_) return;
    const std::lock_guard lock(mutex_);
    gate.Stop(why_);
  }

  // Waits for the next tick, reads what was measured, and sends what is commanded. An exception of
  // the port or of a user's controller stops the arm.
  void Exchange() {
    try {
      // The program may have done other work since the link was made.
      if (!std::exchange(began_, true)) WaitForArm();
      due_ += period;
      if (port->now() > due_) due_ = port->now();  // a delay is not caught up
      port->WaitUntil(due_);
      Read();
      Send(WantedOpening());
    } catch (const Error& error) {
      gate.Stop(error.what());
    } catch (...) {
      Hold();
      stopped_ = true;
      gate.Stop("its port was interrupted");
      throw;
    }
  }

  void Read() {
    if (port->Read(read_)) gate.Accept(read_, port->now());
  }

  void Send(double opening) {
    Controller& controller = robot.controller(group);
    const ArmCommand* command =
        controller.mode() == CtrlMode::kTorque
            ? gate.NextForces(WantedForces(controller), opening, port->now())
            : gate.Next(WantedPositions(controller), opening, port->now());
    if (command) port->Send(*command);
  }

  static std::span<const double> WantedPositions(const Controller& controller) {
    if (controller.mode() != CtrlMode::kPosition) {
      throw Error(fmt::format("its controller '{}' commands neither joint positions nor torques",
                              controller.kind()));
    }
    return controller.commanded_joint_pos();
  }

  std::span<const double> WantedForces(Controller& controller) const {
    if (controller.port_kind() != TargetKind::kJointTorques) {
      throw Error(fmt::format(
          "its controller '{}' commands motors by itself; only torques of 'joint_torque' are sent",
          controller.kind()));
    }
    if (!port->takes_forces()) {
      throw Error(fmt::format("{} takes no torques; command joint positions", port->name()));
    }
    return controller.command_port();
  }

  double WantedOpening() const {
    if (gripper.empty() || !robot.is_driven(gripper)) return kNoOpening;
    const Controller& controller = robot.controller(gripper);
    if (controller.target_kind() != TargetKind::kOpening) return kNoOpening;
    return controller.target()[0];
  }

  // The fingers go where those of the arm are; the command stays.
  void FollowOpening() {
    const double opening = gate.measured().opening;
    if (gripper.empty() || !std::isfinite(opening)) return;
    GripperGroup& fingers = Gripper();
    fingers.GetCtrl(saved_);
    fingers.CtrlForOpening(std::clamp(opening, 0.0, 1.0), follow_);
    fingers.SetCtrl(follow_);
    follows_ = true;
  }

  // Returns how many ticks braking may take, and going back from a force.
  int TicksToRest() const {
    double longest = 0;
    for (size_t i = 0; i < gate.command().vel.size(); ++i) {
      longest = std::max(longest, std::abs(gate.command().vel[i]) / gate.limits().acceleration[i]);
    }
    return static_cast<int>(std::ceil((longest + kLongestYield) / period));
  }

  // Brakes within the limits, then holds.
  void ComeToRest() {
    stopped_ = true;
    try {
      for (int tick = TicksToRest(); tick > 0; --tick) {
        port->WaitUntil(port->now() + period);
        Read();
        const ArmCommand* command = gate.Next({}, kNoOpening, port->now());
        if (!command) break;
        port->Send(*command);
        if (gate.is_at_rest()) break;
      }
    } catch (const std::exception& error) {
      LogWarn(fmt::format("{}: {}", place, error.what()));
    }
    Hold();
  }

  ArmMeasurement read_;
  std::vector<double> saved_, follow_;  // controls of the gripper
  std::atomic<bool> renewed_ = false, asked_to_stop_ = false;
  std::mutex mutex_;
  std::string why_;
  double due_ = 0, timeout_ = 0;
  int at_step_ = 0;
  bool tied_ = true, began_ = false, stopped_ = false, held_ = false, follows_ = false,
       dry_run_ = false;
};

ArmLink::ArmLink(Robot robot, std::shared_ptr<ArmPort> port, const ArmLinkOptions& options) {
  if (!port) throw ArgumentError("a link needs a port");
  const auto* simulated = dynamic_cast<const SimulatedArm*>(port.get());
  if (simulated && simulated->robot().scene() == robot.scene()) {
    throw ArgumentError(fmt::format(
        "{} is in the scene that is linked to it; give it one of its own", port->name()));
  }
  Scene scene = robot.scene();
  const std::string key =
      fmt::format("arm link of {} / {}", robot.name(), ArmName(robot, options.group));
  const auto other = std::dynamic_pointer_cast<Impl>(scene.FindObserver(key));
  if (other && other->is_tied())
    throw ArgumentError(fmt::format("{} is linked already; close that link first", other->place));
  impl_ = std::make_shared<Impl>(std::move(robot), std::move(port), options);
  scene.AddObserver(impl_, key);
  impl_->hook = scene.AddResetHook([weak = std::weak_ptr<Impl>(impl_)](ResetContext&) {
    const auto impl = weak.lock();
    if (impl && impl->is_tied()) impl->WriteMeasured();
  });
}

ArmLink::~ArmLink() {
  if (!impl_) return;
  try {
    Close();
  } catch (const std::exception& error) {
    LogWarn(fmt::format("{}: {}", impl_->place, error.what()));
  }
}

ArmLink::ArmLink(ArmLink&&) noexcept = default;

void ArmLink::Close() {
  impl_->Untie();
  if (impl_->scene.closed() || impl_->hook < 0) return;
  impl_->scene.RemoveResetHook(std::exchange(impl_->hook, -1));
}

bool ArmLink::closed() const { return !impl_->is_tied(); }
bool ArmLink::ok() const {
  return impl_->is_tied() && state() != ArmState::kStopped && !impl_->is_asked_to_stop();
}
ArmState ArmLink::state() const { return impl_->gate.state(); }
const std::string& ArmLink::reason() const { return impl_->gate.reason(); }
const SafetyCounts& ArmLink::counts() const { return impl_->gate.counts(); }
const ArmMeasurement& ArmLink::measured() const { return impl_->gate.measured(); }
const ArmCommand& ArmLink::command() const { return impl_->gate.command(); }
const ArmLimits& ArmLink::limits() const { return impl_->gate.limits(); }
double ArmLink::period() const { return impl_->period; }
const Robot& ArmLink::robot() const { return impl_->robot; }
ArmPort& ArmLink::port() const { return *impl_->port; }

void ArmLink::Renew() { impl_->Renew(); }
void ArmLink::Stop(const std::string& reason) { impl_->AskToStop(reason); }

bool ArmLink::MoveTo(std::span<const double> q, double timeout, const std::function<void()>& each) {
  Impl& s = *impl_;
  Controller& controller = s.robot.controller(s.group);
  const std::string& place = s.robot.group(s.group).place();
  if (controller.port_kind() != TargetKind::kJointPositions) {
    throw ArgumentError(fmt::format(
        "{}: its controller '{}' takes {}, so no joint positions can be commanded; install "
        "'joint_position' first",
        place, controller.kind(), Describe(controller.port_kind())));
  }
  const std::span<double> goal = controller.command_port();
  RequireValues([&] { return place; }, "joint", q, static_cast<int>(goal.size()));
  std::ranges::copy(q, goal.begin());
  const double end = s.port->now() + timeout;
  while (ok() && s.port->now() < end) {
    s.robot.Update();
    if (!s.scene.Step().ok()) return false;
    if (each) each();
    const std::vector<double>& at = measured().pos;
    const bool is_there =
        std::equal(q.begin(), q.end(), at.begin(), at.end(),
                   [](double a, double b) { return std::abs(a - b) <= kArrived; });
    if (is_there) return true;
  }
  return false;
}

}  // namespace robocell
