// Controls that hold a pose.
#pragma once

#include <optional>

#include "robocell/mujoco/forward.h"

namespace robocell {

// Whether an actuator's force is gain * ctrl + a + b * length with b < 0: a position servo, or a
// gripper scaled to 0..255 (XML reference, actuator/general).
bool IsPositionServo(const mjModel* model, int actuator);

// The control with which a position servo rests at `length`, clamped to the control range. Nothing
// for other actuators.
std::optional<double> RestingCtrl(const mjModel* model, int actuator, double length);

// The same for where `data` is: its length must be up to date (position stage).
std::optional<double> HoldingCtrl(const mjModel* model, const mjData* data, int actuator);

}  // namespace robocell
