#include "robocell/scene/servo_gains.h"

#include <mujoco/mujoco.h>

#include "robocell/scene/actuator_kind.h"

namespace robocell {
namespace {

// Position servos, and those that integrate their control to a position.
bool HoldsPosition(const mjsActuator* actuator) {
  return actuator->gaintype == mjGAIN_FIXED && actuator->gainprm[0] != 0 &&
         actuator->biastype == mjBIAS_AFFINE && actuator->biasprm[1] < 0;
}

}  // namespace

bool SetServoGains(const ServoGains& gains, mjsActuator* actuator) {
  const bool of_velocity = ActuatorKind(actuator) == CtrlMode::kVelocity;
  if (!HoldsPosition(actuator) && (gains.kp || !of_velocity)) return false;
  if (gains.kp) {
    const double authored = -actuator->biasprm[1];  // first, so that a ratio of one stays exact
    actuator->gainprm[0] = *gains.kp * (actuator->gainprm[0] / authored);
    actuator->biasprm[0] = *gains.kp * (actuator->biasprm[0] / authored);
    actuator->biasprm[1] = -*gains.kp;
  }
  if (gains.kv) actuator->biasprm[2] = -*gains.kv;
  if (gains.kv && of_velocity) actuator->gainprm[0] = *gains.kv;
  return true;
}

}  // namespace robocell
