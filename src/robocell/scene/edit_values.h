// Private to scene: the attributes, masses and gains that elements of a model get while it is being
// written, by `edits` and by a robot's overrides.
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

// Each attribute is in the compiled model as the edit says, or it is a problem at `place`. The name
// is none of them.
void SetEdited(const Edit& edit, mjsElement* element, const std::string& place, CompileLog& log);

// The engine takes the mass of a body from its <inertial> or from its geoms, and says nothing of
// what it does not take: a number that is written where the other counts is lost. Both change the
// model so that the engine takes the mass, kg, or leave it and say why not and what to write
// instead.
//
// The inertia is scaled with the mass. Where it comes from geoms, these keep their shares of it.
std::optional<std::string> SetBodyMass(mjsBody* body, double mass);
std::optional<std::string> SetGeomMass(mjsGeom* geom, double mass);

// The gains of a servo: those of `edits` (kp, kv) and of a robot's overrides (stiffness, damping). N
// or Nm per unit of the actuator's length, and of its velocity; what is not given stays.
struct ServoGains {
  std::optional<double> kp = {}, kv = {};
};

// False for what has no such gain, which is left as it is. kp is of servos for a position, kv of
// these and of velocity servos. What the engine makes of a control stays: a servo whose controls
// are scaled (0..255) goes on resting where it did.
bool SetServoGains(const ServoGains& gains, mjsActuator* actuator);

}  // namespace robocell::internal
