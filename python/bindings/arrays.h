// Numbers in and out of Python: anything array-like in (sequences, numpy, PyKDL.JntArray), new
// numpy arrays out.
#pragma once

#include "bindings.h"
#include <nanobind/ndarray.h>

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/error.h"

namespace robocell::python {

namespace nb = nanobind;

// The numbers of an array of one dimension that are contiguous float64, where they are: valid as
// long as the object given is. Nothing of anything else.
std::optional<std::span<const double>> RowOf(nb::handle value);

// Float64 numbers of anything array-like, flat; read where they are when they are contiguous
// float64. ArgumentError: "<what> must be a list of numbers, got None". The object given must live
// as long, and not be written to meanwhile.
class Doubles {
 public:
  Doubles(nb::handle value, const char* what);

  std::span<const double> span() const { return {array_.data(), array_.size()}; }
  // As numpy sees it.
  std::vector<size_t> shape() const;

 private:
  nb::ndarray<const double, nb::c_contig, nb::device::cpu> array_;
};

// The same as a copy.
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

// A new array that owns the values themselves.
template <class T>
nb::object NewArray(std::vector<T>&& values, std::vector<size_t> shape) {
  auto* owned = new std::vector<T>(std::move(values));
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, T>(owned->data(), shape.size(), shape.data(), owner));
}

// A new array of one dimension: for a few numbers in a third of the time.
nb::object NewRow(std::span<const double> values);
inline nb::object NewArray(const std::vector<double>& values) { return NewRow(values); }

}  // namespace robocell::python
