// Explains calls whose arguments fit no signature. nanobind lists signatures in C++'s terms; this
// gives users the class and method, the wrong argument, the expected and the given value.
// robocell/_arguments.py makes the text.
#pragma once

#include "bindings.h"

namespace robocell::python {

// Applies to all functions, methods, constructors and setters that the module has; call it last.
void ExplainArgumentErrors(nb::module_& m);

}  // namespace robocell::python
