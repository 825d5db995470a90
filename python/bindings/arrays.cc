#include "arrays.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

namespace robocell::python {
namespace {

// PyKDL.JntArray has rows() and indexing, but numpy does not know it.
nb::object AsSequence(nb::handle value) {
  if (!nb::hasattr(value, "rows") || nb::hasattr(value, "__array__")) return nb::borrow(value);
  nb::list list;
  const int rows = nb::cast<int>(value.attr("rows")());
  for (int i = 0; i < rows; ++i) list.append(value[nb::int_(i)]);
  return list;
}

}  // namespace

// By the buffer protocol, which takes half the time of a DLPack capsule.
std::optional<std::span<const double>> RowOf(nb::handle value) {
  if (!PyObject_CheckBuffer(value.ptr())) return std::nullopt;
  Py_buffer buffer;
  if (PyObject_GetBuffer(value.ptr(), &buffer, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0) {
    PyErr_Clear();
    return std::nullopt;
  }
  std::optional<std::span<const double>> row;
  if (buffer.ndim == 1 && buffer.format && std::string_view(buffer.format) == "d")
    row.emplace(static_cast<const double*>(buffer.buf), static_cast<size_t>(buffer.shape[0]));
  PyBuffer_Release(&buffer);
  return row;
}

Doubles::Doubles(nb::handle value, const char* what) {
  if (nb::try_cast(value, array_, /*convert=*/false) && array_.ndim() > 0) return;
  const nb::module_ numpy = nb::module_::import_("numpy");
  const auto refuse = [&] {
    throw ArgumentError(std::string(what) + " must be a list of numbers, got " +
                        nb::cast<std::string>(nb::repr(value)));
  };
  if (value.is_none()) refuse();  // numpy makes NaN of it
  nb::object array;
  try {
    array = numpy.attr("asarray")(AsSequence(value), "float64", "C");
  } catch (nb::python_error& e) {
    if (!e.matches(PyExc_TypeError) && !e.matches(PyExc_ValueError)) throw;
    refuse();
  }
  array_ = nb::cast<decltype(array_)>(array);
  if (array_.ndim() == 0) refuse();
}

std::vector<size_t> Doubles::shape() const {
  std::vector<size_t> shape;
  for (size_t i = 0; i < array_.ndim(); ++i) shape.push_back(array_.shape(i));
  return shape;
}

std::vector<double> ToDoubles(nb::handle value, const char* what, std::vector<size_t>& shape) {
  const Doubles numbers(value, what);
  shape = numbers.shape();
  return {numbers.span().begin(), numbers.span().end()};
}

std::vector<double> ToDoubles(nb::handle value, const char* what) {
  const Doubles numbers(value, what);
  return {numbers.span().begin(), numbers.span().end()};
}

std::vector<double> ToRow(nb::handle value, const char* what) {
  if (const auto there = RowOf(value)) return {there->begin(), there->end()};
  std::vector<size_t> shape;
  std::vector<double> row = ToDoubles(value, what, shape);
  if (shape.size() == 1) return row;
  throw ArgumentError(fmt::format("{} must be a row of numbers, got an array of shape ({})", what,
                                  fmt::join(shape, ", ")));
}

nb::object NewRow(std::span<const double> values) {
  // Kept for good, with the GIL.
  static PyObject* empty = nullptr;
  if (!empty) empty = nb::object(nb::module_::import_("numpy").attr("empty")).release().ptr();
  const nb::int_ size(values.size());
  PyObject* arguments[] = {nullptr, size.ptr()};
  nb::object row = nb::steal(
      PyObject_Vectorcall(empty, arguments + 1, 1 | PY_VECTORCALL_ARGUMENTS_OFFSET, nullptr));
  Py_buffer buffer;
  if (!row.is_valid() || PyObject_GetBuffer(row.ptr(), &buffer, PyBUF_WRITABLE) != 0)
    throw nb::python_error();
  std::copy(values.begin(), values.end(), static_cast<double*>(buffer.buf));
  PyBuffer_Release(&buffer);
  return row;
}

}  // namespace robocell::python
