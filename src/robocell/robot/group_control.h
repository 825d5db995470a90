// Private to robot: a group of a robot, and the controller that drives its actuators.
//
// One arm may belong to several robots, configured or not, each with its own tool or leaf.
// Each has its own group, but an arm's actuators have one driver: all robots whose arm has the same
// joints and actuators share the control.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/kinematics/chain_source.h"
#include "robocell/robot/arm_ports.h"
#include "robocell/robot/group_factory.h"

namespace robocell::internal {

// Prefix of the keys of all controls (ControlledGroup::control_key()).
inline constexpr std::string_view kControlKey = "control:";

// A group, its possible drives, and the chain to its leaf.
class ControlledGroup {
 public:
  // Includes its chain, if it has a tip. `options` without qpos.
  ControlledGroup(const Scene& scene, MadeGroup made, std::string root_body,
                  const ChainOptions& options);

  // Reads the chain again, with the bodies that hang on it at `qpos` or, by default, at the
  // reference.
  void RemakeChain(const mjModel* model, std::span<const double> qpos = {});
  // Returns true if the model was written to since the chain was read from it.
  bool is_stale(const mjModel* model) const { return source_.IsStale(model); }
  bool refreshed() const { return refreshed_; }  // the chain is not that of the reference
  // Returns a key of the actuators; "" for a group that shares no control.
  const std::string& control_key() const { return control_key_; }

  std::shared_ptr<MoveGroup> group;
  Drives drives;
  const ArmGroup* arm = nullptr;    // the group, if it is an ArmGroup
  GripperGroup* gripper = nullptr;  // the group, if it is a GripperGroup
  BaseGroup* base = nullptr;        // the group, if it is a BaseGroup
  std::optional<ChainTip> tip;      // tip of an arm whose chain is known
  std::optional<Chain> chain;       // chain from the root body to `tip`

 private:
  std::string root_body_, tool_body_;
  std::string control_key_;
  ChainSource source_;  // source of `chain`
  bool refreshed_ = false;
  std::vector<std::shared_ptr<void>>
      companions_;  // companions of former chains, see Chain::companion()
};

// The controller of a group, and the buffer that carries the control to the engine. The scene keeps
// the shared ones by their key, as observers without events.
struct GroupControl : SceneObserver {
  ArmPorts ports;
  std::shared_ptr<ControlledGroup> of;     // the robot whose group the controller works on
  std::shared_ptr<Controller> controller;  // declared last: destroyed first
  MoveGroup* drive = nullptr;              // the one in use, of the same
  std::string why_no_controller;
  std::vector<double> ctrl;
  bool chosen = false;  // explicitly, rather than by the configuration or by default

  // Runs one tick.
  void Run() {
    controller->Compute(ctrl);
    drive->SetCtrl(ctrl);
  }
  // Makes filtered and delayed position servos begin as if their target had been `q` for long:
  // otherwise they would begin at their last target, in another mode or at another place.
  void SettleLags(std::span<const double> q);
  // Forgets the command, and holds the group in place.
  void Reset();
  // The group was teleported at this time of the scene: its actuators hold it there from now on.
  // Their forces are those of the old place until the engine computes them again.
  void PlaceAt(double time);
  bool may_have_forces_of_before(double time) const { return placed_at_ == time; }
  // Calls `run` with this. A controller may replace itself meanwhile.
  template <class Call>
  void Guarded(Call&& run) {
    const Running running(*this);
    run(*this);
  }
  // Installs a controller that works on `group`, and gives it the group's ports and actuators.
  // Returns the previous controller, which is kept if it is running.
  void Put(std::shared_ptr<Controller> next, std::shared_ptr<ControlledGroup> group,
           MoveGroup& its_drive);

  // The controller of the group, to be restored if another one cannot drive it.
  struct Driven {
    ArmPorts ports;
    std::shared_ptr<ControlledGroup> of;
    std::shared_ptr<Controller> controller;
    MoveGroup* drive = nullptr;
  };
  Driven now() const { return {ports, of, controller, drive}; }
  void PutBack(Driven before);

 private:
  // The driven group, if the start of its servos can be set.
  ServoGroup* PositionServos() const;
  void Replace(std::shared_ptr<ControlledGroup> group, std::shared_ptr<Controller> next,
               MoveGroup* its_drive);
  // Counting references of each controller in every tick would cost more than the rest of the loop;
  // replaced objects are kept instead.
  struct Replaced {
    std::shared_ptr<ControlledGroup> of;
    std::shared_ptr<Controller> controller;
  };
  struct Running {
    explicit Running(GroupControl& c) : control(c) { ++control.running_; }
    ~Running() {
      if (--control.running_ > 0 || control.replaced_.empty()) return;
      const auto going = std::exchange(control.replaced_, {});
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;
    GroupControl& control;
  };

  int running_ = 0;
  std::optional<double> placed_at_;
  std::vector<Replaced> replaced_;
};

}  // namespace robocell::internal
