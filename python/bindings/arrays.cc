#include "arrays.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

// Numpy's own functions. Their addresses are looked up at the first use.
#define NPY_NO_DEPRECATED_API NPY_2_0_API_VERSION
#include <numpy/arrayobject.h>

namespace robocell::python {

using namespace nb::literals;

namespace {

// PyKDL.JntArray has rows() and indexing, but numpy does not know it.
nb::object AsSequence(nb::handle value) {
  if (!nb::hasattr(value, "rows") || nb::hasattr(value, "__array__")) return nb::borrow(value);
  nb::list list;
  const int rows = nb::cast<int>(value.attr("rows")());
  for (int i = 0; i < rows; ++i) list.append(value[nb::int_(i)]);
  return list;
}

void ImportNumpy() {
  if (PyArray_ImportNumPyAPI() != 0) throw nb::python_error();
}

PyArrayObject* AsArray(nb::handle array) { return reinterpret_cast<PyArrayObject*>(array.ptr()); }

bool IsNumpyArray(nb::handle value) {
  ImportNumpy();
  return PyArray_Check(value.ptr());
}

// The buffer protocol is slower: numpy writes type and shape each time.
std::optional<std::span<const double>> RowOfArray(PyArrayObject* array) {
  const bool is_row = PyArray_NDIM(array) == 1 && PyArray_TYPE(array) == NPY_DOUBLE &&
                      PyArray_ISCARRAY_RO(array);  // native, aligned, contiguous
  if (!is_row) return std::nullopt;
  return std::span(static_cast<const double*>(PyArray_DATA(array)),
                   static_cast<size_t>(PyArray_DIM(array, 0)));
}

// Other objects may create their buffer on request, and release it with the request.
std::optional<std::span<const double>> RowOfView(nb::handle value) {
  if (!PyMemoryView_Check(value.ptr())) return std::nullopt;
  Py_buffer buffer;
  if (PyObject_GetBuffer(value.ptr(), &buffer, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0) {
    PyErr_Clear();
    return std::nullopt;
  }
  std::optional<std::span<const double>> row;
  const bool is_aligned = reinterpret_cast<uintptr_t>(buffer.buf) % alignof(double) == 0;
  if (is_aligned && buffer.ndim == 1 && buffer.format && std::string_view(buffer.format) == "d")
    row.emplace(static_cast<const double*>(buffer.buf), static_cast<size_t>(buffer.shape[0]));
  PyBuffer_Release(&buffer);
  return row;
}

int NumpyType(nb::dlpack::dtype type) {
  static constexpr std::array kTypes = {
      std::pair{nb::dtype<double>(), NPY_DOUBLE},   std::pair{nb::dtype<float>(), NPY_FLOAT},
      std::pair{nb::dtype<int32_t>(), NPY_INT32},   std::pair{nb::dtype<int64_t>(), NPY_INT64},
      std::pair{nb::dtype<uint16_t>(), NPY_UINT16}, std::pair{nb::dtype<uint8_t>(), NPY_UINT8},
      std::pair{nb::dtype<bool>(), NPY_BOOL}};
  for (const auto& [each, number] : kTypes) {
    if (each == type) return number;
  }
  throw Error("no array has numbers of this type");
}

// Uses numbers of its own if none are given; flags would then mean columns first.
nb::object MakeArray(void* numbers, nb::dlpack::dtype type, std::span<const size_t> shape) {
  ImportNumpy();
  std::array<npy_intp, NPY_MAXDIMS> sizes;
  std::copy(shape.begin(), shape.end(), sizes.begin());
  nb::object array = nb::steal(PyArray_New(&PyArray_Type, static_cast<int>(shape.size()),
                                           sizes.data(), NumpyType(type), nullptr, numbers, 0,
                                           numbers ? NPY_ARRAY_CARRAY : 0, nullptr));
  if (!array.is_valid()) throw nb::python_error();
  return array;
}

}  // namespace

std::optional<std::span<const double>> RowOf(nb::handle value) {
  if (!PyObject_CheckBuffer(value.ptr())) return std::nullopt;
  return IsNumpyArray(value) ? RowOfArray(AsArray(value)) : RowOfView(value);
}

std::optional<std::span<double>> WritableRowOf(nb::handle value) {
  if (!IsNumpyArray(value) || !PyArray_ISWRITEABLE(AsArray(value))) return std::nullopt;
  const auto row = RowOfArray(AsArray(value));
  if (!row) return std::nullopt;
  return std::span(static_cast<double*>(PyArray_DATA(AsArray(value))), row->size());
}

std::optional<std::span<const double>> MatrixOf(nb::handle value, size_t rows, size_t columns) {
  if (!IsNumpyArray(value)) return std::nullopt;
  PyArrayObject* array = AsArray(value);
  const bool fits = PyArray_NDIM(array) == 2 && PyArray_TYPE(array) == NPY_DOUBLE &&
                    PyArray_ISCARRAY_RO(array) &&
                    static_cast<size_t>(PyArray_DIM(array, 0)) == rows &&
                    static_cast<size_t>(PyArray_DIM(array, 1)) == columns;
  if (!fits) return std::nullopt;
  return std::span(static_cast<const double*>(PyArray_DATA(array)), rows * columns);
}

bool HasRealNumbers(nb::handle array) {
  const auto kind = nb::cast<std::string>(array.attr("dtype").attr("kind"));
  if (kind != "O") return kind == "f" || kind == "i" || kind == "u";
  const nb::object real = nb::module_::import_("numbers").attr("Real");
  for (const nb::handle each : nb::object(array.attr("flat"))) {
    if (PyBool_Check(each.ptr()) || !nb::isinstance(each, real)) return false;
  }
  return true;
}

Doubles::Doubles(nb::handle value, const char* what) {
  if (nb::try_cast(value, array_, /*convert=*/false) && array_.ndim() > 0) return;
  const nb::module_ numpy = nb::module_::import_("numpy");
  const auto refuse = [&] {
    throw ArgumentError(std::string(what) + " must be a list of numbers, got " +
                        nb::cast<std::string>(nb::repr(value)));
  };
  nb::object array;
  try {
    array = numpy.attr("asarray")(AsSequence(value));
  } catch (nb::python_error& e) {
    if (!e.matches(PyExc_TypeError) && !e.matches(PyExc_ValueError)) throw;
    refuse();
  }
  // Numpy would turn None into NaN, text into numbers, and drop imaginary parts.
  if (!HasRealNumbers(array)) refuse();
  array_ = nb::cast<decltype(array_)>(array.attr("astype")("float64", "order"_a = "C"));
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

std::string ShapeText(std::span<const size_t> shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

Unwritten NewUnwritten(nb::dlpack::dtype type, std::span<const size_t> shape) {
  Unwritten made{MakeArray(nullptr, type, shape)};
  made.numbers = PyArray_DATA(AsArray(made.array));
  return made;
}

nb::object NewArrayOver(void* numbers, nb::dlpack::dtype type, std::span<const size_t> shape,
                        nb::handle owner) {
  nb::object array = MakeArray(numbers, type, shape);
  if (numbers && PyArray_SetBaseObject(AsArray(array), owner.inc_ref().ptr()) != 0)
    throw nb::python_error();
  return array;
}

nb::object NewRow(std::span<const double> values) {
  const size_t size = values.size();
  Unwritten made = NewUnwritten(nb::dtype<double>(), {&size, 1});
  std::copy(values.begin(), values.end(), static_cast<double*>(made.numbers));
  return std::move(made.array);
}

}  // namespace robocell::python
