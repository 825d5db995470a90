// The position port: drives each joint of a group to a target through its own servo, within the
// joint's limits.
#pragma once

#include <memory>
#include <vector>

#include "robocell/robot/beyond_limits.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/joint_group.h"
#include "robocell/robot/move_group.h"
#include "robocell/robot/port_values.h"

namespace robocell {

// The target of a gripper is its opening (gripper_opening_controller.h), that of every other group
// its joint positions. Throws ArgumentError if an actuator is not a position servo of one of the
// joints.
std::unique_ptr<Controller> MakeJointPositionController(MoveGroup& group);

class JointPositionController : public Controller {
 public:
  static constexpr std::string_view kKind = "joint_position";
  explicit JointPositionController(MoveGroup& group);

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { group_.RequireOpen(); }
  const Scene* scene() const override { return group_.scene(); }
  int target_size() const override { return group_.nq(); }
  void SetTarget(std::span<const double> target) override;
  std::span<const double> target() const override { return target_.get(); }
  std::span<const double> commanded_joint_pos() const override { return target_.get(); }
  std::span<double> command_port() override { return target_.get(); }
  bool UsePort(std::span<double> port) override { return target_.MoveTo(port); }
  void Reset() override;
  void ResetTo(std::span<const double> servos) override;
  bool GetSteadyTarget(std::span<const double> q, std::span<const double> v,
                       std::span<const double> gravity, std::span<const double> resistance,
                       std::span<double> out) const override;
  // Values beyond a joint's limits drive the joint to its limit, or the servo to the end of its
  // ctrlrange, and are logged once. Joints without a command are not logged.
  void Compute(std::span<double> ctrl) override;

 private:
  // Returns true after SetTarget(), or after a number was written into the port.
  bool IsCommanded(size_t joint) const { return commanded_ || target_[joint] != held_[joint]; }
  void WarnOfCutCtrl(std::span<const double> ctrl);

  MoveGroup& group_;
  const ServoGroup* servos_;  // the same, if it can report clipped controls
  PortValues target_;
  std::vector<double> held_;  // the target without a command
  bool commanded_ = false;
  std::vector<double> within_;    // the target inside the limits, scratch
  std::vector<Interval> limits_;  // servo limits at the last Compute(), others at the last reset
  BeyondLimits beyond_;
};

}  // namespace robocell
