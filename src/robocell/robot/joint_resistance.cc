#include "robocell/robot/joint_resistance.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/mujoco/actuators.h"

namespace robocell {
namespace {

double SpringTorque(const mjModel* m, int joint, double q) {
  const double x = q - m->qpos_spring[m->jnt_qposadr[joint]];
  const mjtNum* high = m->jnt_stiffnesspoly + mjNPOLY * joint;
  return x * (m->jnt_stiffness[joint] + x * (high[0] + x * high[1]));
}

double DamperTorque(double linear, const mjtNum* high, double v) {
  const double speed = std::abs(v);
  return v * (linear + speed * (high[0] + speed * high[1]));
}

double FrictionTorque(double loss, double v) { return v == 0 ? 0 : std::copysign(loss, v); }

void AddActuatorDampers(const mjModel* m, const std::vector<int>& joints,
                        std::span<const double> velocity, std::span<double> torque) {
  for (int a = 0; a < m->nactuator; ++a) {
    const mjtNum* high = m->actuator_dampingpoly + mjNPOLY * a;
    if (m->actuator_damping[a] == 0 && high[0] == 0 && high[1] == 0) continue;
    if (!ActsOnJoint(m, a)) continue;
    const auto joint = std::find(joints.begin(), joints.end(), m->actuator_trnid[2 * a]);
    if (joint == joints.end()) continue;
    const auto i = joint - joints.begin();
    const double gear = Gear(m, a);
    torque[i] += gear * gear * DamperTorque(m->actuator_damping[a], high, velocity[i]);
  }
}

}  // namespace

static_assert(mjNPOLY == 2);

void AddJointResistance(const mjModel* m, const std::vector<int>& joints, std::span<const double> q,
                        std::span<const double> velocity, std::span<double> torque) {
  const int off = m->opt.disableflags;
  const bool springs = !(off & mjDSBL_SPRING), dampers = !(off & mjDSBL_DAMPER);
  // A constraint of the engine's.
  const bool friction = !(off & (mjDSBL_FRICTIONLOSS | mjDSBL_CONSTRAINT));
  for (size_t i = 0; i < joints.size(); ++i) {
    const int dof = m->jnt_dofadr[joints[i]];
    if (springs) torque[i] += SpringTorque(m, joints[i], q[i]);
    if (dampers) {
      torque[i] +=
          DamperTorque(m->dof_damping[dof], m->dof_dampingpoly + mjNPOLY * dof, velocity[i]);
    }
    if (friction) torque[i] += FrictionTorque(m->dof_frictionloss[dof], velocity[i]);
  }
  if (dampers) AddActuatorDampers(m, joints, velocity, torque);
}

}  // namespace robocell
