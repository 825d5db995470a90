#include "robocell/robot/arm_group.h"

#include <mujoco/mujoco.h>

#include "robocell/base/error.h"

namespace robocell {

const Chain& ArmGroup::chain() const {
  if (has_chain()) return **chain_;
  throw NotFoundError(place() + " has no chain, which its controller needs: kinematics need the " +
                      "configured arm of a robot");
}

void ArmGroup::GravityTorques(std::span<const double> q, std::span<double> out) const {
  chain().GravityTorques(q, gravity_in_base(), out);
}

void ArmGroup::InverseDynamics(std::span<const double> q, std::span<const double> qd,
                               std::span<const double> qdd, std::span<double> out) const {
  chain().InverseDynamics(q, qd, qdd, gravity_in_base(), out);
}

void ArmGroup::CtrlForJointTorque(std::span<const double> torque, std::span<double> ctrl) const {
  core().Bind();
  const mjModel* m = core().model();
  const std::vector<int>& ids = core().actuator_ids();
  for (size_t i = 0; i < ids.size(); ++i) {
    const double gear = m->actuator_gear[6 * m->actuator_outadr[ids[i]]];
    ctrl[i] = torque[i] / (gear * m->actuator_gainprm[mjNGAIN * ids[i]]);
  }
}

void ArmGroup::CtrlForJointVel(std::span<const double> velocity, std::span<const double> torque,
                               std::span<double> ctrl) const {
  core().Bind();
  const mjModel* m = core().model();
  const std::vector<int>& ids = core().actuator_ids();
  for (size_t i = 0; i < ids.size(); ++i) {
    const double gear = m->actuator_gear[6 * m->actuator_outadr[ids[i]]];
    ctrl[i] = gear * velocity[i] + torque[i] / (gear * m->actuator_gainprm[mjNGAIN * ids[i]]);
  }
}

void ArmGroup::JointPosForTorque(std::span<const double> q, std::span<const double> torque,
                                 std::span<double> out) const {
  core().Bind();
  const mjModel* m = core().model();
  const std::vector<int>& ids = core().actuator_ids();
  for (size_t i = 0; i < ids.size(); ++i) {
    const double gear = m->actuator_gear[6 * m->actuator_outadr[ids[i]]];
    out[i] = q[i] - torque[i] / (gear * gear * m->actuator_biasprm[mjNBIAS * ids[i] + 1]);
  }
}

}  // namespace robocell
