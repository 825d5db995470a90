// The enums of specs, and the spec classes, each after its parts.
#pragma once

#include "bindings.h"

namespace robocell::python {

void BindEnums(nb::module_& m);
void BindRobotSpecs(nb::module_& m);
void BindSceneSpecs(nb::module_& m);
void BindPickSpecs(nb::module_& m);
void BindTaskSpecs(nb::module_& m);
void BindSceneSourceSpecs(nb::module_& m);
void BindRandomizeSpecs(nb::module_& m);
void BindRunSpecs(nb::module_& m);
void BindEnvSpecs(nb::module_& m);

}  // namespace robocell::python
