// Grasps of any object by any hand.
#pragma once

#include "bindings.h"

namespace robocell::python {

void BindGrasps(nb::module_& m);

}  // namespace robocell::python
