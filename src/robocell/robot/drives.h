// Private to robot: the actuators that can drive an arm, one set per control mode, and switching
// between them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "robocell/robot/arm_group.h"
#include "robocell/spec/ctrl_mode.h"

namespace robocell::internal {

struct Drives {
  // Groups by CtrlMode; null for a missing mode, with its reason beside it.
  std::array<std::shared_ptr<MoveGroup>, kCtrlModes> groups = {};
  std::array<std::string, kCtrlModes> why_none = {};

  // Mode of the arm's own actuators; empty without actuators, or if they have no kind or several
  // kinds.
  std::optional<CtrlMode> native = {};

  MoveGroup* of(CtrlMode mode) const { return groups[static_cast<size_t>(mode)].get(); }
  const std::string& why_not(CtrlMode mode) const { return why_none[static_cast<size_t>(mode)]; }
};

// Returns the drives of a group with only its own actuators. Does not keep the group.
Drives OwnDrive(const std::shared_ptr<MoveGroup>& group);
// Returns the drives of an arm: its own actuators and those that were added to the scene for its
// joints (RobotSpec::control_modes). `why_no_actuators` explains why it has no actuators.
Drives FindDrives(const Scene& scene, const std::shared_ptr<ArmGroup>& arm, GroupNames names,
                  const std::string& why_no_actuators);

// Switches on the actuators of `mode` and off those of the other modes. Returns false, and writes
// nothing, if that is already the case, which also works on a frozen model; otherwise a frozen
// model is an Error.
bool SwitchTo(CtrlMode mode, const Drives& drives, const Scene& scene);
// Remembers which of a scene's actuators are switched on, to restore that.
class ModeSwitches {
 public:
  explicit ModeSwitches(const Scene& scene);
  // Does nothing for a scene that was closed or whose model was replaced.
  void PutBack(const Scene& scene) const;

 private:
  uint64_t generation_;
  int off_;
};
// Returns the mode whose actuators are on. Unset for a group with a single mode, or if other code
// switched on more than one, or none.
std::optional<CtrlMode> ModeNow(const Drives& drives, const Scene& scene);
// Returns the controller of a mode's port: "joint_torque".
std::string PortController(CtrlMode mode);

}  // namespace robocell::internal
