// Controllers and control modes in Python.
#pragma once

#include "bindings.h"
#include "robocell/robot/robot.h"

namespace robocell::python {

void BindControllers(nb::module_& m);
// A robot's command ports, its control mode and its controllers.
void DefControl(nb::class_<Robot>& robot);

}  // namespace robocell::python
