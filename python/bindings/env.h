// What the bindings of environments share.
#pragma once

#include "bindings.h"
#include "robocell/env/env.h"

namespace robocell::python {

// The last observation, as dictionaries of copies.
nb::dict Observation(const Env& env);

// EnvState and EnvRecord, and what an environment does with them.
void BindEnvState(nb::module_& m);
void DefEnvState(nb::class_<Env>& env);

}  // namespace robocell::python
