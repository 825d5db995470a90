// Numbers in and out of Python: anything array-like in (sequences, numpy, PyKDL.JntArray), new
// numpy arrays out.
#pragma once

#include "bindings.h"
#include <nanobind/ndarray.h>

#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/error.h"

namespace robocell::python {

namespace nb = nanobind;

// Flat float64 values of `value`. ArgumentError: "<what> must be a list of numbers, got None".
std::vector<double> ToDoubles(nb::handle value, const char* what);
// The same of one dimension only: a matrix is an ArgumentError, whatever its size.
std::vector<double> ToRow(nb::handle value, const char* what);
// The same with the shape, as numpy sees it.
std::vector<double> ToDoubles(nb::handle value, const char* what, std::vector<size_t>& shape);

// A new array that owns a copy of `values`.
template <class T>
nb::object NewArray(std::span<const T> values, std::vector<size_t> shape) {
  auto* owned = new std::vector<T>(values.begin(), values.end());
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, T>(owned->data(), shape.size(), shape.data(), owner));
}

inline nb::object NewArray(const std::vector<double>& values) {
  return NewArray<double>(std::span<const double>(values), {values.size()});
}

}  // namespace robocell::python
