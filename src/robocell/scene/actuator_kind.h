// Determines the kind of an actuator by its force as a function of its control, in models under
// construction and in compiled ones. No other code does this.
//
// A kind is named by the mode that an arm of such actuators is in (ctrl_mode.h). With force =
// gain * ctrl + a + b * length + c * velocity (XML reference, actuator/general):
//   kPosition  position servo: b < 0; its control may be filtered, and scaled (grippers, 0..255)
//   kVelocity  velocity servo: gain = -c > 0, a = b = 0
//   kTorque    motor: no a, b, c
// All others have no kind: servos that integrate their control, dampers, muscles, actuators with
// several inputs, and those with gear 0, which push nothing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"
#include "robocell/spec/ctrl_mode.h"

struct mjsActuator_;
typedef struct mjsActuator_ mjsActuator;

namespace robocell::internal {

std::optional<CtrlMode> ActuatorKind(const mjModel* model, int actuator);
std::optional<CtrlMode> ActuatorKind(const mjsActuator* actuator);

// Returns the kind of an actuator whose activation is its control, for any filter or integrator
// precedes it.
std::optional<CtrlMode> ActuatorForceKind(const mjModel* model, int actuator);

inline bool IsPositionServo(const mjModel* model, int actuator) {
  return ActuatorKind(model, actuator) == CtrlMode::kPosition;
}
inline bool IsPositionServo(const mjsActuator* actuator) {
  return ActuatorKind(actuator) == CtrlMode::kPosition;
}

// Returns true if it acts on one joint, not through a tendon or at a site (as in
// mujoco/actuators.h).
bool ActsOnJoint(const mjsActuator* actuator);

// Describes an actuator: "a motor", "a servo that integrates its control", "without effect, as its
// gear is 0".
std::string DescribeActuator(const mjModel* model, int actuator);
std::string DescribeActuator(const mjsActuator* actuator);
// Returns "position servo", "velocity servo" or "motor".
const char* ActuatorWord(CtrlMode kind);

// The actuators that act on joints, in the model's order, with full names.
struct JointActuator {
  std::string joint, name;
  std::optional<CtrlMode> kind = {};
};
std::vector<JointActuator> JointActuators(const mjModel* model);
std::vector<JointActuator> JointActuators(const mjSpec* spec);

// The actuators that drive the joints of an arm which names none: those of one kind, the first on
// each joint; "" for a joint without one. It is the kind that drives most joints; among equals,
// position precedes velocity and torque; no kind if none drives any joint. Actuators added for
// other modes (control_modes.h) do not count.
struct ArmDrive {
  std::optional<CtrlMode> kind = {};
  std::vector<std::string> names = {};  // one per joint

  bool complete() const;
};
ArmDrive FindArmDrive(const std::vector<std::string>& joints,
                      const std::vector<JointActuator>& actuators);

}  // namespace robocell::internal
