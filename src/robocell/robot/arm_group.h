// ArmGroup: joints of one degree of freedom each, moved by one actuator each: position servos,
// velocity servos or motors. A switchable arm has one such group per mode, over the same joints;
// controllers work on the group of their mode.
//
// It knows the arm's chain, from the robot base frame to the leaf frame, so that controllers can
// use gravity and inertia. Errors: those of GroupCore; NotFoundError without a chain. Functions
// that controllers call every tick do not allocate.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/kinematics/chain.h"
#include "robocell/robot/joint_group.h"
#include "robocell/spec/ctrl_mode.h"
#include "robocell/spec/task_space.h"

namespace robocell {

class ArmGroup : public JointGroupOf<MoveGroup> {
 public:
  ArmGroup(const Scene& scene, GroupNames names)
      : JointGroupOf(scene, std::move(names), MoveGroupKind::kArm) {}

  // `chain` is read whenever it is needed, because it may be replaced. It must outlive the group's
  // use.
  void UseChain(const std::optional<Chain>* chain) { chain_ = chain; }
  // Returns true if other joints follow those of the arm (mujoco/couplings.h).
  bool has_followers() const { return !core().followers().empty(); }
  bool has_chain() const { return chain_ && chain_->has_value(); }
  const Chain& chain() const;
  // Returns the configured part of its poses that counts, if any.
  std::optional<TaskSpaceConfig> task_space() const;

  // Like SetJointPos, but computes dependent values only on demand or in the next step.
  void WriteJointPos(std::span<const double> q) { core().WriteJointPos(q); }
  // Returns the first joint that `q` puts beyond its limits by more than rounding; nq() if there is
  // none. No allocation.
  size_t FindBeyondLimits(std::span<const double> q) const;
  // Returns simulated seconds.
  double time() const { return core().scene().time(); }
  Eigen::Vector3d gravity_in_base() const { return core().gravity_in_base(); }
  // Computes torques that hold the joints at `q` against gravity, N m or N.
  void GravityTorques(std::span<const double> q, std::span<double> out) const;
  // Computes torques that accelerate joints at `q` and `qd` by `qdd`, including gravity, N m or N.
  void InverseDynamics(std::span<const double> q, std::span<const double> qd,
                       std::span<const double> qdd, std::span<double> out) const;

  // Adds the resistance of the joints' springs, dampers and friction when they move at `velocity`
  // (joint_resistance.h), N m or N.
  void AddResistance(std::span<const double> q, std::span<const double> velocity,
                     std::span<double> torque) const;

  // Returns the torque range of a joint's motor; +-infinity without a limit.
  Interval torque_limit(size_t joint) const;
  // Returns the first joint from `from` on whose motor cannot apply its `torque`, or only just;
  // nv() if there is none. No allocation.
  size_t FindStrained(std::span<const double> torque, size_t from) const;
  // Computes the controls of motors that apply `torque`.
  void CtrlForJointTorque(std::span<const double> torque, std::span<double> ctrl) const;
  // Computes the controls of velocity servos that drive joints, which move at `now`, at `velocity`
  // and apply `torque` on top. The force stays within the servo's limit: a servo clipped by its
  // limit is a switch, which stiff servos of light joints would toggle at every step.
  void CtrlForJointVel(std::span<const double> velocity, std::span<const double> now,
                       std::span<const double> torque, std::span<double> ctrl) const;
  // Computes targets at which position servos apply `torque` to joints at `q` that move at `v`.
  void JointPosForTorque(std::span<const double> q, std::span<const double> v,
                         std::span<const double> torque, std::span<double> out) const;

 private:
  // The same functions for arms whose actuators act together (scene/drive_matrix.h).
  Interval TorqueLimitOfMatrix(size_t joint) const;
  void CtrlForTorqueOfMatrix(std::span<const double> torque, std::span<double> ctrl) const;
  void CtrlForVelocityOfMatrix(std::span<const double> velocity, std::span<const double> torque,
                               std::span<double> ctrl) const;
  void PositionForTorqueOfMatrix(std::span<const double> q, std::span<const double> v,
                                 std::span<const double> torque, std::span<double> out) const;
  Eigen::VectorXd ForcesFor(std::span<const double> torque) const;

  Interval TorqueLimit(const mjModel* m, size_t joint) const;
  bool IsInsideLimits(const mjModel* m, size_t joint, double torque) const;
  // Restricts `limit` to the force limits of actuator and joint.
  Interval WithinForceLimits(const mjModel* m, size_t joint, Interval limit) const;

  const std::optional<Chain>* chain_ = nullptr;
};

}  // namespace robocell
