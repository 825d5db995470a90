// ArmGroup: joints of one degree of freedom each, moved by one actuator each: position servos,
// velocity servos or motors. An arm that can be switched has one such group per mode, over the same
// joints; controllers work on the group of their mode.
//
// It knows the arm's chain, from the robot base frame to the leaf, so that controllers can ask for
// gravity and inertia. Errors: those of GroupCore; NotFoundError without a chain. No allocation in
// what controllers call every tick.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/kinematics/chain.h"
#include "robocell/robot/joint_group.h"
#include "robocell/spec/ctrl_mode.h"

namespace robocell {

class ArmGroup : public JointGroupOf<MoveGroup> {
 public:
  ArmGroup(const Scene& scene, GroupNames names)
      : JointGroupOf(scene, std::move(names), MoveGroupKind::kArm) {}

  // `chain` is looked at whenever it is needed: it may be made anew. It outlives the group's use.
  void UseChain(const std::optional<Chain>* chain) { chain_ = chain; }
  bool has_chain() const { return chain_ && chain_->has_value(); }
  const Chain& chain() const;

  // As SetJointPos, but what follows from it is computed when next asked for, or stepped.
  void WriteJointPos(std::span<const double> q) { core().WriteJointPos(q); }
  // The first joint that `q` puts beyond its limits, by more than rounding; nq() when there is
  // none. No allocation.
  size_t FindBeyondLimits(std::span<const double> q) const;
  // Simulated seconds.
  double time() const { return core().scene().time(); }
  Eigen::Vector3d gravity_in_base() const { return core().gravity_in_base(); }
  // Torques that hold the joints at `q` against gravity, N m or N.
  void GravityTorques(std::span<const double> q, std::span<double> out) const;
  // Torques that accelerate joints at `q` and `qd` by `qdd`, including gravity, N m or N.
  void InverseDynamics(std::span<const double> q, std::span<const double> qd,
                       std::span<const double> qdd, std::span<double> out) const;

  // Adds what the joints' springs, dampers and friction resist with when they move at `velocity`
  // (joint_resistance.h), N m or N.
  void AddResistance(std::span<const double> q, std::span<const double> velocity,
                     std::span<double> torque) const;

  // Torque range of a joint's motor; +-infinity without a limit.
  Interval torque_limit(size_t joint) const;
  // The first joint from `from` on whose motor cannot push with its `torque`, or may just not; nv()
  // when there is none. No allocation.
  size_t FindStrained(std::span<const double> torque, size_t from) const;
  // The controls of motors that push with `torque`.
  void CtrlForJointTorque(std::span<const double> torque, std::span<double> ctrl) const;
  // The controls of velocity servos that drive joints that move at `now` at `velocity`, and push
  // with `torque` on top: no harder than they can, because a servo that is cut off by its limit is
  // a switch, which stiff ones of light joints would go on throwing at every step.
  void CtrlForJointVel(std::span<const double> velocity, std::span<const double> now,
                       std::span<const double> torque, std::span<double> ctrl) const;
  // Targets at which position servos push with `torque` on joints at `q` that move at `v`.
  void JointPosForTorque(std::span<const double> q, std::span<const double> v,
                         std::span<const double> torque, std::span<double> out) const;

 private:
  Interval TorqueLimit(const mjModel* m, size_t joint) const;
  bool IsInsideLimits(const mjModel* m, size_t joint, double torque) const;
  // `limit` within what the forces of actuator and joint are limited to.
  Interval WithinForceLimits(const mjModel* m, size_t joint, Interval limit) const;

  const std::optional<Chain>* chain_ = nullptr;
};

}  // namespace robocell
