// Numbers of a model that are infinite or none at all. The engine compiles many of them, and only
// the simulation shows it: a body that is nowhere, a mass that is another one.
#pragma once

#include <mujoco/mujoco.h>

#include <string>

namespace robocell {

// The first element that is made of such a number, as the engine words its own complaints:
// "Error: pos is 0 inf 0.1; ...\nElement name 'upper', id 2". "" when all are finite. Ranges, which
// may be open, user data, and what the engine derives are not looked at.
std::string NonFiniteElement(const mjModel* model);

}  // namespace robocell
