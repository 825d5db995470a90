// Private to scene: what a number of Scene::state() is, for messages.
#pragma once

#include <cstddef>
#include <string>

#include "robocell/mujoco/forward.h"

namespace robocell {

// "the position of joint 'elbow'", "the control of actuator 'servo2'", "number 3 of the
// activations" for the number at `index` of a state (mjSTATE_INTEGRATION) of the model, which it
// has.
std::string DescribeStateNumber(const mjModel* model, size_t index);

}  // namespace robocell
