// Joint impedance: each joint of an arm is a spring and a damper towards its target, for any weight
// of the arm.
//
//   torque = stiffness * (target - q) - damping * qd + gravity + Coriolis
//
//   auto& impedance = robot.SetController<JointImpedanceController>("arm");
//   impedance.SetStiffness(std::vector<double>(7, 400.0));       // Nm/rad
//   robot.jnt_pos_cmd()[3] += 0.1;
//
// It needs the control mode torque. Damping is damping_ratio * 2 sqrt(stiffness * inertia), with
// the joint's own inertia in the middle of the limits: 1 is critical there. By default the
// stiffness makes joints swing at 3 Hz, light ones faster. Compute does not allocate.
#pragma once

#include <vector>

#include "robocell/robot/arm_group.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/port_values.h"

namespace robocell {

class JointImpedanceController : public Controller {
 public:
  static constexpr std::string_view kKind = "joint_impedance";
  // Throws NotFoundError for an arm without a chain.
  explicit JointImpedanceController(ArmGroup& arm);

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { arm_.RequireOpen(); }
  const Scene* scene() const override { return arm_.scene(); }
  CtrlMode mode() const override { return CtrlMode::kTorque; }
  int target_size() const override { return arm_.nq(); }
  void SetTarget(std::span<const double> q) override;
  std::span<const double> target() const override { return target_.get(); }
  std::span<const double> commanded_joint_pos() const override { return target_.get(); }
  std::span<double> command_port() override { return target_.get(); }
  bool UsePort(std::span<double> port) override { return target_.MoveTo(port); }
  void Reset() override { arm_.GetJointPos(target_.get()); }
  bool GetSteadyTarget(std::span<const double> q, std::span<const double> v,
                       std::span<const double> gravity, std::span<const double> resistance,
                       std::span<double> out) const override;
  void Compute(std::span<double> ctrl) override;

  // Stiffness of each joint, Nm/rad or N/m. Throws ArgumentError for a wrong number of values, and
  // for negative or not finite ones.
  std::span<const double> stiffness() const { return stiffness_; }
  void SetStiffness(std::span<const double> stiffness);
  double damping_ratio() const { return damping_ratio_; }
  void SetDampingRatio(double ratio);

 private:
  void ComputeDamping();

  ArmGroup& arm_;
  std::vector<double> inertia_, stiffness_, damping_;
  double damping_ratio_ = 1;
  PortValues target_;
};

// Returns the joint-space inertia of each joint alone in the middle of its limits, kg m^2 or kg.
std::vector<double> MiddleInertia(const Chain& chain);

// Returns the values, one for each joint. Throws ArgumentError unless there are `expected` values
// (or one for all), none negative. `place` and `what` begin the message: "group 'arm': stiffness".
std::vector<double> PositiveGains(std::string_view place, std::string_view what,
                                  std::span<const double> values, int expected);

}  // namespace robocell
