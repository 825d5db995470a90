// Controller: turns the state and a target into the control of one move group. It never steps the
// simulation. Robot::Update() runs each group's controller once per control tick.
//
// A controller keeps only its own state (target, start of a motion); Reset() re-seeds it so that a
// group without a command holds still. It may keep a reference to its group, which outlives it.
// Controllers are made by name through the registry, where users can add their own:
//
//   RegisterController("mine", [](MoveGroup& g) { return std::make_unique<Mine>(g); });
//   robot.SetController("arm", "mine");
//
// One that drives motors or velocity servos says so by its mode; it is then made for the group that
// has these actuators, an ArmGroup, and switched to when it is put in.
//
// Errors: see each function. Threads: the registry may be used from any; a controller belongs to
// its scene's thread.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/robot/move_group.h"
#include "robocell/spec/ctrl_mode.h"

namespace robocell {

// What numbers are that a controller is told.
enum class TargetKind {
  kJointPositions,
  kJointSteps,  // added to the present target
  kOpening,     // of a gripper
  kJointVelocities,
  kJointTorques,
  kPose,      // of the leaf in the robot base frame: x y z, quaternion xyzw
  kTwist,     // of the leaf: linear, then angular velocity
  kBasePose,  // of a base in the world: x y z, quaternion xyzw
};
// "joint positions", "a pose" ... for messages.
const char* Describe(TargetKind kind);

class Controller {
 public:
  virtual ~Controller() = default;

  virtual std::string_view kind() const = 0;  // "joint_position", ...
  // ClosedError when the scene of its group was closed.
  virtual void RequireOpen() const {}
  // The scene of its group; null where neither knows of one.
  virtual const Scene* scene() const { return nullptr; }
  // What it drives.
  virtual CtrlMode mode() const { return CtrlMode::kPosition; }
  virtual TargetKind target_kind() const { return TargetKind::kJointPositions; }
  // Number of values in a target.
  virtual int target_size() const = 0;
  // ArgumentError for a wrong size or a value that is not finite, naming group and joint.
  virtual void SetTarget(std::span<const double> target) = 0;
  virtual std::span<const double> target() const = 0;
  // What the group is being driven to: nq() absolute joint positions, or a gripper's opening. Where
  // no positions are commanded, those that were last measured.
  virtual std::span<const double> commanded_joint_pos() const = 0;
  // What the group is being driven to, for writing in place (the robot's command port), and what
  // these numbers are. What is written is checked when it is used.
  virtual std::span<double> command_port() = 0;
  virtual TargetKind port_kind() const { return target_kind(); }
  // Asks it to keep these numbers in `port`, which has as many: it copies them there, and reads and
  // writes them there until it is asked again; with an empty one back in a place of its own. That
  // keeps the robot's port in one place while controllers change. false: it keeps to its own.
  virtual bool UsePort(std::span<double> port) {
    (void)port;
    return false;
  }
  // Forget the target and hold: the present joint positions, or what a gripper is commanded to.
  virtual void Reset() = 0;
  // The same where it takes over an arm from something else. `start` is for position servos nq()
  // joint positions: those at which they push as what drove the arm, which are not where the joints
  // are; for velocity servos the nv() velocities that the joints have.
  virtual void ResetTo(std::span<const double> start) {
    (void)start;
    Reset();
  }
  // Writes the joint-position target under which joints at `q` go on moving at `v`: ahead of the
  // joints by what they lag and sag. `gravity` holds the joints against gravity, `resistance`
  // overcomes their springs, dampers and friction, N m or N. False where the target is unknown or
  // not finite. No allocation.
  virtual bool GetSteadyTarget(std::span<const double> q, std::span<const double> v,
                               std::span<const double> gravity, std::span<const double> resistance,
                               std::span<double> out) const {
    (void)q, (void)v, (void)gravity, (void)resistance, (void)out;
    return false;
  }
  // The control for this tick, nu() values. No allocation.
  virtual void Compute(std::span<double> ctrl) = 0;
};

// Throws the ArgumentError for values that are too few, too many or not finite: "robot 'left' /
// group 'arm': expected 7 joint values, got 3".
[[noreturn]] void ThrowBadValues(std::string_view place, std::string_view what,
                                 std::span<const double> values, int expected,
                                 const std::vector<std::string>& names);

// Checks that there are `expected` finite values. `place()` says what is being told, and is called
// only for an error; `what` is "joint", "opening" ...; `names` are those of the values, if any.
template <class Place>
void RequireValues(const Place& place, std::string_view what, std::span<const double> values,
                   int expected, const std::vector<std::string>& names = {}) {
  bool good = values.size() == static_cast<size_t>(expected);
  for (const double v : values) good &= std::isfinite(v);
  if (!good) ThrowBadValues(place(), what, values, expected, names);
}

using ControllerFactory = std::function<std::unique_ptr<Controller>(MoveGroup&)>;

// Adds a kind of controller; ArgumentError when the name is taken or the factory empty. `mode` is
// that of the controllers made.
void RegisterController(const std::string& kind, ControllerFactory factory,
                        CtrlMode mode = CtrlMode::kPosition);
// ArgumentError, which begins with `place`, for a built-in kind that groups like this one cannot
// have: a gripper is driven by joint_position alone. It lists those that the group can have.
void RequireControllable(const MoveGroup& group, const std::string& kind, const std::string& place);
// NotFoundError lists the kinds; else what RequireControllable and the factory throw.
std::unique_ptr<Controller> MakeController(const std::string& kind, MoveGroup& group);
// The mode of a kind. `place` begins the message of a NotFoundError.
CtrlMode ControllerMode(const std::string& kind, const std::string& place);
std::vector<std::string> ControllerKinds();

}  // namespace robocell
