// What the bindings of environments share.
#pragma once

#include "bindings.h"
#include "robocell/env/env.h"

namespace robocell::python {

// "environment 'duo'".
std::string Place(const Env& env);

// The last observation, as dictionaries of copies.
nb::dict Observation(const Env& env);

// ((path, begin, size), ...) of a vector's parts: where a path leads to in dictionaries.
nb::tuple ActionParts(const EnvLayout& layout);
nb::tuple ObservationParts(const EnvLayout& layout);

// The Python object of its task, for the collector; null for other tasks, and while something else
// in C++ shares that reference.
PyObject* TargetOfTask(const Env& env);

// EnvState and EnvRecord, and what an environment does with them.
void BindEnvState(nb::module_& m);
void DefEnvState(nb::class_<Env>& env);

}  // namespace robocell::python
