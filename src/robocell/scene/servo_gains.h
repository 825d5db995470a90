// Private to scene: the gains of servos in a model that is being written, the one place that
// changes them: for `edits` (kp, kv) and for a robot's overrides (stiffness, damping).
#pragma once

#include <optional>
#include <string>

#include "robocell/mujoco/forward.h"

struct mjsActuator_;
typedef struct mjsActuator_ mjsActuator;

namespace robocell {

// N or Nm per unit of the actuator's length, and of its velocity; what is not given stays.
struct ServoGains {
  std::optional<double> kp = {}, kv = {};
};

// False for what has no such gain, which is left as it is. kp is of servos for a position, kv of
// these and of velocity servos. What the engine makes of a control stays: a servo whose controls
// are scaled (0..255) goes on resting where it did.
bool SetServoGains(const ServoGains& gains, mjsActuator* actuator);

}  // namespace robocell
