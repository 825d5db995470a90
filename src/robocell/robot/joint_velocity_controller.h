// The velocity port: velocity servos drive each joint at the commanded velocity, with a
// feedforward: gravity and Coriolis torques at the present state, and the resistance of joint
// springs, dampers and friction loss to the commanded velocity. So the servos only correct errors,
// and there is no integrator.
//
// A moving arm that is switched to velocity mode brakes: its velocity falls to 1/e in 0.1 s, so
// that the force does not jump. A joint with a commanded velocity is driven at that from then on.
#pragma once

#include <memory>
#include <vector>

#include "robocell/robot/arm_group.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/port_values.h"

namespace robocell::internal {

// Throws ArgumentError unless the group is an arm.
std::unique_ptr<Controller> MakeJointVelocityController(MoveGroup& group);

class JointVelocityController : public Controller {
 public:
  static constexpr std::string_view kKind = "joint_velocity";
  explicit JointVelocityController(ArmGroup& arm);

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { arm_.RequireOpen(); }
  const Scene* scene() const override { return arm_.scene(); }
  CtrlMode mode() const override { return CtrlMode::kVelocity; }
  TargetKind target_kind() const override { return TargetKind::kJointVelocities; }
  int target_size() const override { return arm_.nv(); }
  void SetTarget(std::span<const double> velocity) override;
  std::span<const double> target() const override { return velocity_.get(); }
  std::span<const double> commanded_joint_pos() const override { return q_; }
  std::span<double> command_port() override { return velocity_.get(); }
  bool UsePort(std::span<double> port) override { return velocity_.MoveTo(port); }
  void Reset() override;
  void ResetTo(std::span<const double> start) override;
  void Compute(std::span<double> ctrl) override;

 private:
  // Returns the present velocity targets of the joints.
  std::span<const double> Driven();

  ArmGroup& arm_;
  PortValues velocity_;
  std::vector<double> still_, feedforward_;
  std::vector<double> q_, qd_;  // last measured values
  std::vector<double> start_, driven_;
  double started_ = 0;    // simulated s
  bool braking_ = false;  // true while it brakes from `start_`
};

}  // namespace robocell::internal
