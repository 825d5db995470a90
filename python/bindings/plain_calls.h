// Plain calls: of functions that are called in microseconds, the form that loops give them. A
// fifth of such a call would go into finding out what was meant: fourteen arguments, each with a
// default and several types.
//
// A plain call looks at what it was given and answers it, or declines: anything unusual, and all
// that fails, is left to nanobind's own call of the function, which so is the one place that says
// what arguments mean and what is wrong with them.
#pragma once

#include "bindings.h"

namespace robocell::python {

// The arguments as in CPython's vectorcall, the object first; the count without its flags. A new
// reference; null, and no error set, where it declines.
using PlainCall = PyObject* (*)(PyObject* const* args, size_t count, PyObject* keywords);

// For a function of a class, before ExplainArgumentErrors.
void SetPlainCall(nb::handle function, PlainCall call);
// That of a function, or null.
PlainCall PlainCallOf(nb::handle function);

}  // namespace robocell::python
