// Private to spec: checks that an environment's objects have one id each and stand in the right
// frame.
#pragma once

#include "robocell/spec/env_config.h"

namespace robocell::internal {

// Adds a problem for an id that is used twice (which makes its frame ambiguous), that is a robot's
// name, or whose elements would have names that begin like those of a robot or gripper.
void ValidateEnvObjects(const EnvConfig& env, Problems& problems);

}  // namespace robocell::internal
