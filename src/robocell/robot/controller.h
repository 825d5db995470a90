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
// A controller that drives motors or velocity servos declares it by its mode; it is then made for
// the group that has these actuators, an ArmGroup, and the arm switches to it when the controller
// is installed.
//
// Errors: see each function. Threads: any thread may use the registry; a controller belongs to its
// scene's thread.
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

// The meaning of the numbers in a controller's target.
enum class TargetKind {
  kJointPositions,
  kJointSteps,  // added to the present target
  kOpening,     // opening of a gripper
  kJointVelocities,
  kJointTorques,
  kPose,      // leaf frame in the robot base frame: x y z, quaternion xyzw
  kTwist,     // twist of the leaf frame: linear, then angular velocity
  kBasePose,  // base pose in the world: x y z, quaternion xyzw
};
// Describes the kind for messages: "joint positions", "a pose", ...
const char* Describe(TargetKind kind);

class Controller {
 public:
  virtual ~Controller() = default;

  virtual std::string_view kind() const = 0;  // "joint_position", ...
  // Throws ClosedError if the scene of its group was closed.
  virtual void RequireOpen() const {}
  // Returns the scene of its group; null if neither knows of one.
  virtual const Scene* scene() const { return nullptr; }
  // Returns the kind of actuators that it drives.
  virtual CtrlMode mode() const { return CtrlMode::kPosition; }
  virtual TargetKind target_kind() const { return TargetKind::kJointPositions; }
  // Returns the number of values in a target.
  virtual int target_size() const = 0;
  // Throws ArgumentError, with group and joint, for a wrong size or a value that is not finite.
  virtual void SetTarget(std::span<const double> target) = 0;
  virtual std::span<const double> target() const = 0;
  // Returns the present command of the group: nq() absolute joint positions, or a gripper's
  // opening. Without commanded positions, the last measured ones.
  virtual std::span<const double> commanded_joint_pos() const = 0;
  // Return the present command of the group for writing in place (the robot's command port), and
  // the kind of these numbers. Written values are checked when they are used.
  virtual std::span<double> command_port() = 0;
  virtual TargetKind port_kind() const { return target_kind(); }
  // Makes the controller keep these numbers in `port`, which has as many: it copies them there, and
  // reads and writes them there until the next call; with an empty port, back in a place of its
  // own. That keeps the robot's port in one place while controllers change. Returns false if it
  // keeps its own place.
  virtual bool UsePort(std::span<double> port) {
    (void)port;
    return false;
  }
  // Forgets the target and holds: the present joint positions, or a gripper's present command.
  virtual void Reset() = 0;
  // Resets a controller that takes over an arm from another one. For position servos, `start` has
  // nq() joint positions at which they apply the force of the previous drive, which differ from the
  // joints' positions; for velocity servos, the joints' nv() velocities.
  virtual void ResetTo(std::span<const double> start) {
    (void)start;
    Reset();
  }
  // Writes the joint-position target under which joints at `q` continue to move at `v`: ahead of
  // the joints by their lag and sag. `gravity` holds the joints against gravity, `resistance`
  // overcomes their springs, dampers and friction, N m or N. Returns false if the target is unknown
  // or not finite. No allocation.
  virtual bool GetSteadyTarget(std::span<const double> q, std::span<const double> v,
                               std::span<const double> gravity, std::span<const double> resistance,
                               std::span<double> out) const {
    (void)q, (void)v, (void)gravity, (void)resistance, (void)out;
    return false;
  }
  // Computes the control for this tick, nu() values. No allocation.
  virtual void Compute(std::span<double> ctrl) = 0;
};

// Throws ArgumentError for values that are too few, too many or not finite: "robot 'left' / group
// 'arm': expected 7 joint values, got 3".
[[noreturn]] void ThrowBadValues(std::string_view place, std::string_view what,
                                 std::span<const double> values, int expected,
                                 const std::vector<std::string>& names);

// Checks that there are `expected` finite values. `place()` names the target, and is called only
// for an error; `what` is "joint", "opening" ...; `names` are those of the values, if any.
template <class Place>
void RequireValues(const Place& place, std::string_view what, std::span<const double> values,
                   int expected, const std::vector<std::string>& names = {}) {
  bool good = values.size() == static_cast<size_t>(expected);
  for (const double v : values) good &= std::isfinite(v);
  if (!good) ThrowBadValues(place(), what, values, expected, names);
}

using ControllerFactory = std::function<std::unique_ptr<Controller>(MoveGroup&)>;

// Adds a kind of controller. Throws ArgumentError if the name is taken or the factory empty. `mode`
// is that of the controllers made.
void RegisterController(const std::string& kind, ControllerFactory factory,
                        CtrlMode mode = CtrlMode::kPosition);
// Throws ArgumentError, which begins with `place`, for a built-in kind that groups like this one
// cannot have: only joint_position drives a gripper. The message lists the possible kinds.
void RequireControllable(const MoveGroup& group, const std::string& kind, const std::string& place);
// Throws NotFoundError that lists the kinds, and the errors of RequireControllable and the factory.
std::unique_ptr<Controller> MakeController(const std::string& kind, MoveGroup& group);
// Returns the mode of a kind. `place` begins the message of a NotFoundError.
CtrlMode ControllerMode(const std::string& kind, const std::string& place);
std::vector<std::string> ControllerKinds();

}  // namespace robocell
