// Private to spec: an environment's objects, which have one id each and stand in the right frame.
#pragma once

#include "robocell/spec/env_config.h"

namespace robocell::internal {

// Adds a problem for an id that is used twice (which decides between frames), that is a robot's
// name, or whose elements would have names that begin like those of a robot or gripper.
void ValidateEnvObjects(const EnvConfig& env, Problems& problems);

}  // namespace robocell::internal
