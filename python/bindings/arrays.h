// Numbers from and to Python: reads anything array-like (sequences, numpy, PyKDL.JntArray), returns
// new numpy arrays.
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

// Returns the numbers of a one-dimensional array of contiguous float64 in place: valid as long as
// the given object lives. Unset for anything else.
std::optional<std::span<const double>> RowOf(nb::handle value);
// The same for a writable numpy array.
std::optional<std::span<double>> WritableRowOf(nb::handle value);
// Returns the numbers of a numpy array of that shape, row by row, if they are contiguous float64.
std::optional<std::span<const double>> MatrixOf(nb::handle value, size_t rows, size_t columns);

// Returns true if a numpy array holds floating-point numbers or integers, also as objects, but no
// booleans, text, None or complex numbers.
bool HasRealNumbers(nb::handle array);

// Float64 numbers of anything array-like of real numbers, flat; contiguous float64 is read in
// place. Throws ArgumentError: "<what> must be a list of numbers, got None". The given object must
// live as long, and not be written to meanwhile.
class Doubles {
 public:
  Doubles(nb::handle value, const char* what);

  std::span<const double> span() const { return {array_.data(), array_.size()}; }
  // Returns the shape in numpy's form.
  std::vector<size_t> shape() const;

 private:
  nb::ndarray<const double, nb::c_contig, nb::device::cpu> array_;
};

// The same as a copy.
std::vector<double> ToDoubles(nb::handle value, const char* what);
// The same for one dimension only: a matrix of any size is an ArgumentError.
std::vector<double> ToRow(nb::handle value, const char* what);
// The same with the shape in numpy's form.
std::vector<double> ToDoubles(nb::handle value, const char* what, std::vector<size_t>& shape);

// Returns "(6, 2)", numpy's format.
std::string ShapeText(std::span<const size_t> shape);

// A new C-contiguous array, whose numbers are still to be written in place. Numpy itself makes it,
// in a quarter of the time of an nb::ndarray: calls of a microsecond return some.
struct Unwritten {
  nb::object array;
  void* numbers = nullptr;
};
Unwritten NewUnwritten(nb::dlpack::dtype type, std::span<const size_t> shape);
// Returns a new array over numbers that live as long as `owner`.
nb::object NewArrayOver(void* numbers, nb::dlpack::dtype type, std::span<const size_t> shape,
                        nb::handle owner);

// Returns a new array that owns a copy of `values`.
template <class T>
nb::object NewArray(std::span<const T> values, const std::vector<size_t>& shape) {
  Unwritten made = NewUnwritten(nb::dtype<T>(), shape);
  std::copy(values.begin(), values.end(), static_cast<T*>(made.numbers));
  return std::move(made.array);
}

// Returns a new array that owns the values themselves, as type `As`.
template <class T, class As = T>
nb::object NewArray(std::vector<T>&& values, const std::vector<size_t>& shape) {
  static_assert(sizeof(T) == sizeof(As));
  auto* owned = new std::vector<T>(std::move(values));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return NewArrayOver(owned->data(), nb::dtype<As>(), shape, owner);
}

// Returns a new one-dimensional array.
nb::object NewRow(std::span<const double> values);
inline nb::object NewArray(const std::vector<double>& values) { return NewRow(values); }

}  // namespace robocell::python
