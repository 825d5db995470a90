// CtrlMode: the actuators that drive the joints of an arm: position servos, velocity servos or
// motors.
#pragma once

#include <array>

#include "robocell/spec/fields.h"

namespace robocell {

enum class CtrlMode { kPosition, kVelocity, kTorque };
template <>
struct EnumNames<CtrlMode> {
  static constexpr std::array kNames = {std::pair{CtrlMode::kPosition, "position"},
                                        std::pair{CtrlMode::kVelocity, "velocity"},
                                        std::pair{CtrlMode::kTorque, "torque"}};
};
inline constexpr int kCtrlModes = 3;

}  // namespace robocell
