#include "robocell/robot/joint_resistance.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/mujoco/actuators.h"

namespace robocell::internal {
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

// Returns the slope of a friction constraint of the engine per rad/s at constant speed: stiffness
// of the constraint times its braking rate (mj_makeImpedance, mj_referenceConstraint).
double FrictionSlope(const mjModel* m, int dof) {
  const mjtNum *solref = m->dof_solref + mjNREF * dof, *solimp = m->dof_solimp + mjNIMP * dof;
  const auto impedance = [](double x) { return std::clamp<double>(x, mjMINIMP, mjMAXIMP); };
  const double least = impedance(solimp[0]), most = impedance(solimp[1]);
  const double compliance =
      std::max<double>((1 - least) / least * m->dof_invweight0[dof], mjMINVAL);
  if (solref[0] <= 0) return -solref[1] / (most * compliance);
  const bool is_safe = !(m->opt.disableflags & mjDSBL_REFSAFE);
  const double time_constant =
      is_safe ? std::max<double>(solref[0], 2 * m->opt.timestep) : solref[0];
  return 2 / (std::max<double>(most * time_constant, mjMINVAL) * compliance);
}

// The engine's friction grows with the speed up to the loss: the full loss would accelerate a
// creeping joint to the speed at which friction is that large.
double FrictionTorque(const mjModel* m, int dof, double v) {
  const double loss = m->dof_frictionloss[dof];
  return loss == 0 ? 0 : std::clamp(v * FrictionSlope(m, dof), -loss, loss);
}

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
    if (friction) torque[i] += FrictionTorque(m, dof, velocity[i]);
  }
  if (dampers) AddActuatorDampers(m, joints, velocity, torque);
}

}  // namespace robocell::internal
