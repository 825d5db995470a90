// Cartesian impedance: springs and dampers along and about the axes of the robot base frame hold
// the TCP of an arm at its target; a null-space task pulls redundant joints towards a posture
// without moving the TCP.
//
//   force  = stiffness * (target - pose) - damping * velocity
//   torque = J^T force + N^T posture torque + gravity + Coriolis
//
//   auto& soft = robot.SetController<CartesianImpedanceController>("arm");
//   soft.SetStiffness({800, 800, 100, 40, 40, 40});        // N/m, then Nm/rad
//   soft.SetPose(target_in_robot);
//
// It needs the control mode torque. With damping_ratio 1 no motion of the TCP overshoots, for any
// present operational-space inertia; N is the dynamically consistent null space (O. Khatib, "A
// unified approach for motion and force control of robot manipulators", 1987). Poses are in the
// robot base frame. Compute does not allocate.
#pragma once

#include <array>
#include <vector>

#include "robocell/control/operational_space.h"
#include "robocell/control/pose_target.h"
#include "robocell/robot/arm_group.h"
#include "robocell/robot/controller.h"

namespace robocell {

class CartesianImpedanceController : public Controller {
 public:
  static constexpr std::string_view kKind = "cartesian_impedance";
  using Gains = std::array<double, 6>;

  // Throws NotFoundError for an arm without a chain.
  explicit CartesianImpedanceController(ArmGroup& arm);

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { arm_.RequireOpen(); }
  const Scene* scene() const override { return arm_.scene(); }
  CtrlMode mode() const override { return CtrlMode::kTorque; }
  TargetKind target_kind() const override { return TargetKind::kPose; }
  int target_size() const override { return 7; }
  void SetTarget(std::span<const double> numbers) override;
  std::span<const double> target() const override { return target_; }
  std::span<const double> commanded_joint_pos() const override { return q_; }
  std::span<double> command_port() override { return target_; }
  // Holds the present pose and posture.
  void Reset() override;
  void Compute(std::span<double> ctrl) override;

  void SetPose(const Pose& leaf_in_robot);
  Pose pose() const;

  // x y z in N/m, then about x y z in Nm/rad. Throws ArgumentError for negative or infinite values.
  Gains stiffness() const;
  void SetStiffness(const Gains& stiffness);
  double damping_ratio() const { return damping_ratio_; }
  void SetDampingRatio(double ratio);
  // The posture that attracts redundant joints (rad or m), and the frequency at which they would
  // swing around it, rad/s; 0 switches the attraction off.
  std::span<const double> posture() const { return posture_; }
  void SetPosture(std::span<const double> q);
  double posture_frequency() const { return posture_frequency_; }
  void SetPostureFrequency(double frequency);
  // An additional wrench that the arm exerts on its surroundings, in the axes of the robot base
  // frame: N, then Nm.
  const Gains& feedforward() const { return feedforward_; }
  void SetFeedforward(const Gains& wrench);

 private:
  // Checks target_, which other code writes: a pose or an error.
  void RequireTarget();

  ArmGroup& arm_;
  PoseNumbers target_ = {};
  TcpSprings springs_;
  Gains feedforward_ = {};
  double damping_ratio_ = 1, posture_frequency_ = 5;
  std::vector<double> posture_;
  std::vector<double> q_;
};

}  // namespace robocell
