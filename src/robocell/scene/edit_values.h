// Private to scene: sets attributes, masses and gains of elements of a model under construction,
// for `edits` and for a robot's overrides.
#pragma once

#include <optional>
#include <string>

#include "robocell/mujoco/forward.h"
#include "robocell/scene/compile_log.h"
#include "robocell/spec/edit.h"

struct mjsElement_;
typedef struct mjsElement_ mjsElement;
struct mjsBody_;
typedef struct mjsBody_ mjsBody;
struct mjsGeom_;
typedef struct mjsGeom_ mjsGeom;
struct mjsActuator_;
typedef struct mjsActuator_ mjsActuator;

namespace robocell::internal {

// Sets each attribute such that the compiled model has the edit's value, or reports a problem at
// `place`. The name is not an attribute.
void SetEdited(const Edit& edit, mjsElement* element, const std::string& place, CompileLog& log);

// The engine takes the mass of a body from its <inertial> or from its geoms, and silently ignores
// the other: a number that is written there is lost. This changes the model so that the engine
// takes the mass, kg, or leaves it unchanged and returns why, and what to write instead.
//
// The inertia is scaled with the mass. An inertia from geoms keeps their shares.
std::optional<std::string> SetBodyMass(mjsBody* body, double mass);
std::optional<std::string> SetGeomMass(mjsGeom* geom, double mass);

// The gains of a servo: those of `edits` (kp, kv) and of a robot's overrides (stiffness, damping).
// N or Nm per unit of the actuator's length, and of its velocity; unset gains stay.
struct ServoGains {
  std::optional<double> kp = {}, kv = {};
};

// Returns false, and changes nothing, for an actuator without such a gain. kp belongs to position
// servos, kv to these and to velocity servos. The relation between control and rest position stays:
// a servo with scaled controls (0..255) still rests where it did.
bool SetServoGains(const ServoGains& gains, mjsActuator* actuator);

}  // namespace robocell::internal
