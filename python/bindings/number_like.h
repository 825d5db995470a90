// Decides which Python objects are numbers and which are booleans, for fields that take more than
// one kind of value. values.h converts them.
#pragma once

#include <string>
#include <string_view>

#include "bindings.h"

namespace robocell::python {

// Accepts True or False, also NumPy's.
inline bool IsBool(nb::handle value) {
  if (PyBool_Check(value.ptr())) return true;
  const std::string_view type = Py_TYPE(value.ptr())->tp_name;
  return type == "numpy.bool" || type == "numpy.bool_";
}

// Returns the kind of NumPy's type of a scalar or array, such as 'f' or 'i'; 0 for other objects.
inline char NumpyKind(nb::handle value) {
  if (!nb::hasattr(value, "dtype") || !nb::hasattr(value.attr("dtype"), "kind")) return 0;
  return nb::cast<std::string>(value.attr("dtype").attr("kind")).front();
}

// Accepts any numbers.Real except booleans, also NumPy's and in an array without dimensions.
inline bool IsNumber(nb::handle value) {
  PyObject* p = value.ptr();
  if (PyFloat_Check(p) || (PyLong_Check(p) && !PyBool_Check(p))) return true;
  if (PyUnicode_Check(p) || PyBool_Check(p) || PyComplex_Check(p) || !PyNumber_Check(p))
    return false;
  const char kind = NumpyKind(value);
  if (kind != 0 && kind != 'f' && kind != 'i' && kind != 'u') return false;
  return PySequence_Check(p) == 0 ||
         (nb::hasattr(value, "ndim") && nb::cast<int>(value.attr("ndim")) == 0);
}

// Returns true if the type of a number is an integer type. Arrays have __index__ whatever they
// hold.
inline bool IsWholeNumber(nb::handle number) {
  const char kind = NumpyKind(number);
  return kind == 0 ? PyIndex_Check(number.ptr()) != 0 : kind == 'i' || kind == 'u';
}

}  // namespace robocell::python
