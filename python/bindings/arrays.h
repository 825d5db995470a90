// Numbers in and out of Python: anything array-like in (sequences, numpy, PyKDL.JntArray), new
// numpy arrays out.
#pragma once

#include "bindings.h"
#include <nanobind/ndarray.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"

namespace robocell::python {

namespace nb = nanobind;

// The numbers of an array of one dimension that are contiguous float64, where they are: valid as
// long as the object given is. Nothing of anything else.
std::optional<std::span<const double>> RowOf(nb::handle value);
// The same of a numpy array that may be written to.
std::optional<std::span<double>> WritableRowOf(nb::handle value);
// The numbers of a numpy array of that shape, row by row, if they are contiguous float64.
std::optional<std::span<const double>> MatrixOf(nb::handle value, size_t rows, size_t columns);

// Returns true if a numpy array holds floating-point numbers or integers, also as objects, but no
// booleans, text, None or complex numbers.
bool HasRealNumbers(nb::handle array);

// Float64 numbers of anything array-like of real numbers, flat; read where they are when they are
// contiguous float64. ArgumentError: "<what> must be a list of numbers, got None". The object given
// must live as long, and not be written to meanwhile.
class Doubles {
 public:
  Doubles(nb::handle value, const char* what);

  std::span<const double> span() const { return {array_.data(), array_.size()}; }
  // The shape in numpy's terms.
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

// "(6, 2)", as numpy writes it.
std::string ShapeText(std::span<const size_t> shape);

// A new array, C-contiguous, whose numbers are still to be written where they belong. Made by numpy
// itself, in a quarter of the time of an nb::ndarray: calls of a microsecond return some.
struct Unwritten {
  nb::object array;
  void* numbers = nullptr;
};
Unwritten NewUnwritten(nb::dlpack::dtype type, std::span<const size_t> shape);
// A new array over numbers that are there as long as `owner` lives.
nb::object NewArrayOver(void* numbers, nb::dlpack::dtype type, std::span<const size_t> shape,
                        nb::handle owner);

// A new array that owns a copy of `values`.
template <class T>
nb::object NewArray(std::span<const T> values, const std::vector<size_t>& shape) {
  Unwritten made = NewUnwritten(nb::dtype<T>(), shape);
  std::copy(values.begin(), values.end(), static_cast<T*>(made.numbers));
  return std::move(made.array);
}

// A new array that owns the values themselves, which it has as `As`.
template <class T, class As = T>
nb::object NewArray(std::vector<T>&& values, const std::vector<size_t>& shape) {
  static_assert(sizeof(T) == sizeof(As));
  auto* owned = new std::vector<T>(std::move(values));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return NewArrayOver(owned->data(), nb::dtype<As>(), shape, owner);
}

// A new array of one dimension.
nb::object NewRow(std::span<const double> values);
inline nb::object NewArray(const std::vector<double>& values) { return NewRow(values); }

}  // namespace robocell::python
