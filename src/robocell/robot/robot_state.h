// Private to robot: the state that all handles to one robot share.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/robot/base_group.h"
#include "robocell/robot/group_control.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/body_put_observer.h"
#include "robocell/scene/ft_sensor.h"

namespace robocell::internal {

// One of the robot's groups. Slots are replaced with their groups.
struct GroupSlot : std::enable_shared_from_this<GroupSlot> {
  std::shared_ptr<ControlledGroup> own;
  std::shared_ptr<GroupControl> control;  // may be shared, and work on the group of another robot
};

struct FtReading {
  FtSensor sensor;
  Wrench tare = {}, value = {};
};

}  // namespace robocell::internal

namespace robocell {

// The scene keeps the configured robots' states, as observers; they hold it by inner().
class Robot::State : public SceneObserver, public internal::BodyPutObserver {
 public:
  // `record.root_body` and `record.base_body` are bodies of the scene.
  State(const Scene& scene, RobotRecord record, ChainOptions chain_options = {});

  void OnReset() override;
  void OnResetDone() override;
  void OnForward() override;
  void OnRebuild() override;
  // Warns about a held object when any code moves the robot's base, including its group.
  void OnBodyPut(int body, const Pose& pose_in_world) override;
  // Throws ClosedError after the scene was closed.
  void RequireOpen() const {
    if (scene.closed()) ThrowClosed();
  }

  // Adds the group or replaces the one of that name. If a control already drives its actuators, it
  // shares that; else they stay in their present mode, driven by `controller` if that has this
  // mode. A group that this cannot drive gets no controller; with `must_be_driven`, if the
  // configuration names `controller`, that is an error.
  void AddGroup(internal::MadeGroup made, const std::string& controller, bool must_be_driven);
  internal::GroupSlot* Find(const std::string& name);
  // Takes the controls of another state of the same robot, which has groups of the same names.
  void ShareControls(State& other);
  // Returns the first group of the kind; for grippers that of the first arm, see GripperOf().
  internal::GroupSlot* FindKind(MoveGroupKind kind) { return first_[static_cast<size_t>(kind)]; }
  // Returns an arm's gripper: the first one that hangs on the arm's last link, in the order of the
  // file; without such a gripper the first one that no other arm carries. Null for none.
  internal::GroupSlot* GripperOf(const internal::GroupSlot& arm) const;
  // Throws NotFoundError with the alternatives.
  internal::GroupSlot& Require(const std::string& name);
  internal::GroupSlot& RequireKind(MoveGroupKind kind);
  Controller& RequireController(internal::GroupSlot& slot);
  // Returns the group that has the actuators of a mode. Throws ArgumentError with the reason if
  // there is none.
  MoveGroup& RequireDrive(internal::GroupSlot& slot, CtrlMode mode);
  // Calls `run` with the control of each slot that has a controller. A controller may replace
  // itself, its group or others.
  template <class Run>
  void ForControlled(Run&& run) {
    const Running running(*this);
    for (size_t i = 0; i < controls_.size(); ++i) {
      if (controls_[i]->controller) controls_[i]->Guarded(run);
    }
  }
  // Returns a controller of that kind and mode that continues from the one that it replaces: servos
  // that hold the arm against gravity still hold it.
  std::unique_ptr<Controller> Successor(internal::GroupSlot& slot, const std::string& kind,
                                        CtrlMode mode);
  // Installs a controller of the slot's group, and switches to its actuators without a jump of the
  // forces. A failure changes nothing.
  void Use(internal::GroupSlot& slot, std::shared_ptr<Controller> controller);
  const Chain& RequireChain(internal::GroupSlot& slot);

  internal::FtReading& RequireFtSensor(const std::string& name);
  std::vector<std::string> ft_sensor_names() const;

  // Weighs the bodies that hang on the chains at their present positions.
  void RefreshChains();
  // Reads the state of the arm into the ports, and the force-torque sensors.
  void ReadPorts();
  // Logs the first teleport that puts the arm beyond its limits.
  void WarnBeyondLimits(const ArmGroup& arm, std::span<const double> q);
  // Throws ClosedError if its bodies were removed with an object of the scene.
  void RequireBodies() const {
    if (!lost.empty()) ThrowLost();
  }
  std::vector<std::string> group_names() const;
  void AppendGroups(std::vector<std::shared_ptr<MoveGroup>>& out) const;
  // Returns "scene 'pick' / robot 'left'".
  std::string place() const { return "scene '" + scene.name() + "' / robot '" + record.name + "'"; }
  std::string place(const internal::GroupSlot& slot) const {
    return place() + " / group '" + slot.own->group->name() + "'";
  }

  bool is_of_chain() const { return !tip_body.empty(); }

  // Data of every tick, kept together.
  Scene scene;
  std::vector<std::shared_ptr<internal::GroupSlot>> slots;
  std::vector<double> pos, vel, trq;  // the arm's measurement ports
  std::vector<internal::FtReading> ft_sensors;
  std::string lost;  // why it could not follow a rebuild
  bool paused = false, warned_beyond_limits = false;

 private:
  // Pointers into the slots, which own them, so that a tick does not follow several pointers.
  MoveGroup* arm_ = nullptr;
  std::vector<internal::GroupControl*> controls_;

 public:
  RobotRecord record;
  ChainOptions chain_options;
  std::string tip_body;  // full name as given to FromScene(); else ""
  int root_body = -1;
  std::vector<int> bodies, geoms, collision_geoms;
  std::optional<double> reach;

 private:
  // Replaced slots are kept during a loop, like controllers (GroupControl).
  struct Running {
    explicit Running(State& s) : state(s) { ++state.running_; }
    ~Running() {
      if (--state.running_ > 0 || state.replaced_.empty()) return;
      const auto going = std::exchange(state.replaced_, {});  // destructors may replace others
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;
    State& state;
  };
  void KeepIfRunning(std::shared_ptr<void> replaced) {
    if (running_ > 0) replaced_.push_back(std::move(replaced));
  }
  internal::LeavesObject leaving_;

  [[noreturn]] void ThrowClosed() const;
  [[noreturn]] void ThrowLost() const;
  // Gives a new slot its control. Throws ArgumentError if `controller` cannot drive its group, or
  // if an arm of other joints drives some of its actuators.
  void Drive(internal::GroupSlot& slot, const std::string& controller, bool configured);
  // Returns the control of the actuators of that key; null without one.
  std::shared_ptr<internal::GroupControl> FindControl(const std::string& key) const;
  // Throws ArgumentError if other controls drive some of the group's actuators.
  void RequireUndriven(const internal::GroupSlot& slot) const;
  // Replaces the slot's controller by another one of the same mode with the same command.
  void PutInstead(internal::GroupSlot& slot, const std::string& controller);
  // Reads the chain with everything attached to it: at its present place if it was refreshed, else
  // at the reference.
  void ReadChainAgain(internal::ControlledGroup& group) const;
  // Calls `visit` with each group whose chain is used: the slots' own, and those that drive their
  // actuators.
  template <class Visit>
  void ForChains(Visit&& visit);
  std::span<const double> positions() const;  // positions of the whole model
  void FindBodies();
  void FindCollisionGeoms();
  void FindFtSensors();
  void ListKinds();
  std::vector<internal::GroupSlot*> OfKind(MoveGroupKind kind) const;
  // Returns the body that the arm's last joint moves; -1 if it has no joints of the model.
  int LastLink(const internal::GroupSlot& arm) const;
  // Returns true if one of the gripper's joints hangs on the arm's last link.
  bool Carries(const internal::GroupSlot& arm, const internal::GroupSlot& gripper) const;
  // Returns the first arm that carries it; null for none.
  internal::GroupSlot* CarrierOf(const internal::GroupSlot& gripper) const;

  std::array<internal::GroupSlot*, 4> first_ = {};  // see FindKind()
  int running_ = 0;                                 // loops over controllers
  std::vector<std::shared_ptr<void>> replaced_;
  bool reading_ = false;  // the arm writes into the ports
};

}  // namespace robocell
