// Private to robot: the actuators that an arm can be driven by, one set per control mode, and
// switching between them.
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
  // By CtrlMode; null where there is none, for the reason beside it.
  std::array<std::shared_ptr<MoveGroup>, kCtrlModes> groups = {};
  std::array<std::string, kCtrlModes> why_none = {};

  // Mode of the arm's own actuators; empty without actuators, or if they are of no kind or of
  // several.
  std::optional<CtrlMode> native = {};

  MoveGroup* of(CtrlMode mode) const { return groups[static_cast<size_t>(mode)].get(); }
  const std::string& why_not(CtrlMode mode) const { return why_none[static_cast<size_t>(mode)]; }
};

// A group with nothing but its own actuators. Does not keep it.
Drives OwnDrive(const std::shared_ptr<MoveGroup>& group);
// An arm with its own actuators and those that were added to the scene for its joints
// (RobotSpec::control_modes). `why_no_actuators` says why it has none of its own, if so.
Drives FindDrives(const Scene& scene, const std::shared_ptr<ArmGroup>& arm, GroupNames names,
                  const std::string& why_no_actuators);

// Switches on the actuators of `mode` and off those of the other modes. Nothing is written where
// that is so already, which returns false, so that it may be done on a frozen model; else that is
// an Error.
bool SwitchTo(CtrlMode mode, const Drives& drives, const Scene& scene);
// Which of a scene's actuators are switched on, to be put back.
class ModeSwitches {
 public:
  explicit ModeSwitches(const Scene& scene);
  // Nothing to do for a scene that was closed or whose model is another one now.
  void PutBack(const Scene& scene) const;

 private:
  uint64_t generation_;
  int off_;
};
// The mode whose actuators are on. Nothing for a group that has those of one mode only, or when
// somebody switched on more than one, or none.
std::optional<CtrlMode> ModeNow(const Drives& drives, const Scene& scene);
// The controller of a mode's port: "joint_torque".
std::string PortController(CtrlMode mode);

}  // namespace robocell::internal
