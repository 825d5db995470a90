// Actuators of a compiled model: their targets and gears.
//
// An actuator has one or more inputs (nu controls in all, from actuator_ctrladr on) and one or more
// outputs (nout, from actuator_outadr on; six on a body or site frame, three on a ball joint), so
// that only (nactuator x ...) arrays may be indexed by its id. Loops over actuators end at
// nactuator. Ids are not checked.
#pragma once

#include <mujoco/mujoco.h>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

// Returns the six numbers of its first output; all but the first are 0 on a hinge, slide or tendon.
inline const mjtNum* Gears(const mjModel* model, int actuator) {
  return model->actuator_gear + 6 * model->actuator_outadr[actuator];
}
inline mjtNum Gear(const mjModel* model, int actuator) { return *Gears(model, actuator); }

// Returns true if the actuator acts on one joint, not through a tendon or at a site.
inline bool IsOnJoint(int transmission) {
  return transmission == mjTRN_JOINT || transmission == mjTRN_JOINTINPARENT;
}
inline bool ActsOnJoint(const mjModel* model, int actuator) {
  return IsOnJoint(model->actuator_trntype[actuator]);
}

// The joint, tendon, site or body that it acts on; for a slider-crank the crank's site.
struct ActuatorTarget {
  mjtObj kind;
  int id;
};
ActuatorTarget TargetOf(const mjModel* model, int actuator);

// Returns the inertia that rotors add to a tendon: its own armature, and the armature of actuators
// that pull it, behind their gears.
double TendonArmature(const mjModel* model, int tendon);

// Returns the body of an element that guides a tendon (wrap_type, wrap_objid): a joint, site or
// geom; -1 for a pulley.
int BodyOfWrap(const mjModel* model, int wrap);

// Returns one body that an actuator acts on; for a tendon the first of them. -1 if unknown.
int BodyOfActuator(const mjModel* model, int actuator);

}  // namespace robocell::internal
