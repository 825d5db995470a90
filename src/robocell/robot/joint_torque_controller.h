// The torque port: motors apply exactly the commanded torques.
//
// Without a command it applies the torques that held the arm against gravity when it was installed
// or reset.
#pragma once

#include <memory>
#include <vector>

#include "robocell/robot/arm_group.h"
#include "robocell/robot/beyond_limits.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/port_values.h"

namespace robocell::internal {

// Throws ArgumentError unless the group is an arm.
std::unique_ptr<Controller> MakeJointTorqueController(MoveGroup& group);

class JointTorqueController : public Controller {
 public:
  static constexpr std::string_view kKind = "joint_torque";
  explicit JointTorqueController(ArmGroup& arm);

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { arm_.RequireOpen(); }
  const Scene* scene() const override { return arm_.scene(); }
  CtrlMode mode() const override { return CtrlMode::kTorque; }
  TargetKind target_kind() const override { return TargetKind::kJointTorques; }
  int target_size() const override { return arm_.nv(); }
  void SetTarget(std::span<const double> torque) override;
  std::span<const double> target() const override { return torque_.get(); }
  std::span<const double> commanded_joint_pos() const override { return q_; }
  std::span<double> command_port() override { return torque_.get(); }
  bool UsePort(std::span<double> port) override { return torque_.MoveTo(port); }
  void Reset() override;
  // A torque beyond a motor's limit is clipped, and logged once if it was commanded.
  void Compute(std::span<double> ctrl) override;

 private:
  // Returns true after SetTarget(), or after a number was written into the port.
  bool IsCommanded(size_t joint) const { return commanded_ || torque_[joint] != held_[joint]; }
  void WarnOfStrained();

  ArmGroup& arm_;
  PortValues torque_;
  std::vector<double> held_;  // the torques without a command
  bool commanded_ = false;
  std::vector<double> q_;  // last measured values
  BeyondLimits beyond_;
};

// Returns the arm that a controller of torques or velocities was requested for. Throws
// ArgumentError, which begins with the group's place, for any other group.
ArmGroup& RequireArm(MoveGroup& group, std::string_view controller);

}  // namespace robocell::internal
