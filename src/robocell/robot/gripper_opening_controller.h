// The position port of a gripper: its target is an opening, 0 closed ... 1 open.
//
// Fingers stop at an object, so the opening to keep is the commanded one, not the measured one:
// Reset() takes it from the actuator's present control, and an opening commanded at the group
// itself (GripperGroup::Open) or at the actuator is adopted at the next tick.
#pragma once

#include <vector>

#include "robocell/robot/beyond_limits.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/move_group.h"

namespace robocell::internal {

class GripperOpeningController : public Controller {
 public:
  explicit GripperOpeningController(GripperGroup& group);

  std::string_view kind() const override { return "joint_position"; }
  void RequireOpen() const override { group_.RequireOpen(); }
  const Scene* scene() const override { return group_.scene(); }
  TargetKind target_kind() const override { return TargetKind::kOpening; }
  int target_size() const override { return 1; }
  // Values beyond 0..1 are clipped, which is logged once. The actuators get the target at once.
  void SetTarget(std::span<const double> target) override;
  std::span<const double> target() const override { return {&opening_, 1}; }
  std::span<const double> commanded_joint_pos() const override { return target(); }
  std::span<double> command_port() override { return {&opening_, 1}; }
  void Reset() override;
  void Compute(std::span<double> ctrl) override;

 private:
  // Returns the opening that belongs to controls of the actuators.
  double OpeningFor(std::span<const double> ctrl);

  GripperGroup& group_;
  double opening_ = 1;
  std::vector<double> seen_;  // controls of the actuators that this controller knows
  std::vector<double> present_, open_, closed_, tried_;  // scratch
  BeyondLimits beyond_;
};

}  // namespace robocell::internal
