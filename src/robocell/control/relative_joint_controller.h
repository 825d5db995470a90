// Relative joint position: a target is added to the present target, so that tracking errors do not
// accumulate.
#pragma once

#include <vector>

#include "robocell/robot/joint_position_controller.h"

namespace robocell {

class RelativeJointController : public Controller {
 public:
  static constexpr std::string_view kKind = "relative_joint_position";
  explicit RelativeJointController(MoveGroup& group)
      : group_(group), absolute_(group), delta_(group.nq()) {}

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { group_.RequireOpen(); }
  const Scene* scene() const override { return group_.scene(); }
  int target_size() const override { return absolute_.target_size(); }
  // Adds `delta` (rad or m) to the group's present target, and keeps it within the joint limits.
  void SetTarget(std::span<const double> delta) override;
  // Returns the last delta.
  std::span<const double> target() const override { return delta_; }
  TargetKind target_kind() const override { return TargetKind::kJointSteps; }
  TargetKind port_kind() const override { return TargetKind::kJointPositions; }
  std::span<const double> commanded_joint_pos() const override { return absolute_.target(); }
  std::span<double> command_port() override { return absolute_.command_port(); }
  bool UsePort(std::span<double> port) override { return absolute_.UsePort(port); }
  void Reset() override;
  void ResetTo(std::span<const double> servos) override;
  bool GetSteadyTarget(std::span<const double> q, std::span<const double> v,
                       std::span<const double> gravity, std::span<const double> resistance,
                       std::span<double> out) const override {
    return absolute_.GetSteadyTarget(q, v, gravity, resistance, out);
  }
  void Compute(std::span<double> ctrl) override { absolute_.Compute(ctrl); }

 private:
  MoveGroup& group_;
  JointPositionController absolute_;
  std::vector<double> delta_;
};

}  // namespace robocell
