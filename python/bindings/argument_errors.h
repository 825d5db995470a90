// Explains calls whose arguments fit no signature. nanobind lists signatures in C++'s terms; users
// get class and method, which argument is wrong, what is expected and what was given.
// robocell/_arguments.py makes the text.
#pragma once

#include "bindings.h"

namespace robocell::python {

// For all functions, methods, constructors and setters that the module has; call it last.
void ExplainArgumentErrors(nb::module_& m);

}  // namespace robocell::python
