// The torque port: motors push with the torques that are commanded, and nothing else acts.
//
// Without a command it pushes with what held the arm against gravity when it was put in or reset.
#pragma once

#include <memory>
#include <vector>

#include "robocell/robot/arm_group.h"
#include "robocell/robot/beyond_limits.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/port_values.h"

namespace robocell::internal {

// ArgumentError unless the group is an arm's.
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
  // A torque beyond what a motor can do is cut off there, and told once when somebody commanded it.
  void Compute(std::span<double> ctrl) override;

 private:
  // By SetTarget(), or by a number that was written into the port.
  bool IsCommanded(size_t joint) const { return commanded_ || torque_[joint] != held_[joint]; }
  void TellStrained();

  ArmGroup& arm_;
  PortValues torque_;
  std::vector<double> held_;  // the torques without a command
  bool commanded_ = false;
  std::vector<double> q_;  // as last measured
  BeyondLimits beyond_;
};

// The arm that a controller of torques or velocities was asked for; ArgumentError, beginning with
// the group's place, for any other group.
ArmGroup& RequireArm(MoveGroup& group, std::string_view controller);

}  // namespace robocell::internal
