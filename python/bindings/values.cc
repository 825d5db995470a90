#include "values.h"

#include <fmt/format.h>
#include <nanobind/ndarray.h>

#include "arrays.h"
#include "number_like.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell::python {

std::string FieldPath::text() const {
  std::string out = parent ? parent->text() : "";
  if (index >= 0) return out + "[" + std::to_string(index) + "]";
  return out.empty() ? std::string(name) : out + "." + std::string(name);
}

std::string WithArticle(std::string_view noun) {
  const bool vowel = std::string_view("AEIOUaeiou").find(noun.front()) != std::string_view::npos;
  return (vowel ? "an " : "a ") + std::string(noun);
}

std::string TypeName(nb::handle value) {
  if (value.is_none()) return "None";
  return Py_TYPE(value.ptr())->tp_name;
}

void ThrowType(const FieldPath& path, const std::string& expected, nb::handle got) {
  throw nb::type_error(
      fmt::format("{} must be {}, got {}", path.text(), expected, TypeName(got)).c_str());
}

void ThrowValue(const FieldPath& path, const std::string& problem) {
  throw ArgumentError(path.text() + " " + problem);
}

bool ToBool(nb::handle value, const FieldPath& path) {
  if (!IsBool(value)) ThrowType(path, "True or False", value);
  return PyObject_IsTrue(value.ptr()) == 1;
}

int64_t ToInt(nb::handle value, const FieldPath& path, int64_t lowest, int64_t largest) {
  if (PyBool_Check(value.ptr()) || !PyIndex_Check(value.ptr())) {
    ThrowType(path, "a whole number", value);
  }
  const nb::object number = nb::steal(PyNumber_Index(value.ptr()));
  if (!number.is_valid()) throw nb::python_error();
  int overflow = 0;
  const int64_t out = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
  if (overflow != 0 || out < lowest || out > largest) {
    ThrowValue(path, fmt::format("must lie between {} and {}", lowest, largest));
  }
  return out;
}

double ToDouble(nb::handle value, const FieldPath& path) {
  PyObject* p = value.ptr();
  if (PyFloat_CheckExact(p)) return PyFloat_AS_DOUBLE(p);
  if (PyBool_Check(p) || PyUnicode_Check(p) || !PyNumber_Check(p)) {
    ThrowType(path, "a number", value);
  }
  // NumPy's would lose their imaginary part.
  const bool is_complex =
      PyComplex_Check(p) || std::string_view(Py_TYPE(p)->tp_name).starts_with("numpy.c");
  if (is_complex) ThrowType(path, "a number", value);
  const double out = PyFloat_AsDouble(p);
  if (out == -1 && PyErr_Occurred()) {
    PyErr_Clear();
    ThrowType(path, "a number", value);
  }
  return out;
}

bool IsText(nb::handle value) { return PyUnicode_Check(value.ptr()); }

std::string ToText(nb::handle value, const FieldPath& path) {
  nb::object text = nb::borrow(value);
  if (!IsText(value)) {
    text = nb::steal(PyOS_FSPath(value.ptr()));
    if (!text.is_valid()) {
      PyErr_Clear();
      ThrowType(path, "a text", value);
    }
    if (!IsText(text)) ThrowType(path, "a text", value);
  }
  Py_ssize_t size = 0;
  const char* utf8 = PyUnicode_AsUTF8AndSize(text.ptr(), &size);
  if (!utf8) throw nb::python_error();
  return {utf8, static_cast<size_t>(size)};
}

std::string ToKey(nb::handle key, const FieldPath& path) {
  if (!IsText(key) && !nb::hasattr(key, "__fspath__")) ThrowType(path, "keyed by names", key);
  return ToText(key, path);
}

std::vector<nb::object> ToItems(nb::handle value, const FieldPath& path,
                                const std::string& expected) {
  PyObject* p = value.ptr();
  const bool is_whole = IsText(value) || PyBytes_Check(p) || PyByteArray_Check(p) ||
                        nb::isinstance<nb::dict>(value);  // one value, though Python iterates it
  const nb::object iterator = is_whole ? nb::object() : nb::steal(PyObject_GetIter(p));
  if (!iterator.is_valid()) {
    PyErr_Clear();
    ThrowType(path, expected, value);
  }
  std::vector<nb::object> items;
  while (PyObject* item = PyIter_Next(iterator.ptr())) items.push_back(nb::steal(item));
  if (PyErr_Occurred()) throw nb::python_error();
  return items;
}

std::vector<std::string> ToTexts(nb::handle value, const FieldPath& path) {
  if (IsText(value)) return {ToText(value, path)};
  std::vector<std::string> out;
  for (const nb::object& item : ToItems(value, path, "a list of texts")) {
    out.push_back(ToText(item, FieldPath(path, static_cast<Py_ssize_t>(out.size()))));
  }
  return out;
}

bool Numbers::Borrow(nb::handle value) {
  if (const auto row = RowOf(value)) {
    array_ = nb::borrow(value);
    span_ = *row;
    return true;
  }
  using Array = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
  Array array;
  if (!nb::try_cast(value, array, /*convert=*/false)) return false;
  array_ = nb::borrow(value);
  span_ = {array.data(), array.shape(0)};
  return true;
}

Numbers::Numbers(nb::handle value, const FieldPath& path, const char* expected) {
  if (Borrow(value)) return;
  const auto item = [&](nb::handle number) {
    copy_.push_back(ToDouble(number, FieldPath(path, static_cast<Py_ssize_t>(copy_.size()))));
  };
  if (nb::hasattr(value, "rows") && nb::hasattr(value, "columns")) {  // PyKDL.JntArray
    const auto rows = nb::cast<Py_ssize_t>(value.attr("rows")());
    for (Py_ssize_t i = 0; i < rows; ++i) item(value[i]);
  } else {
    for (const nb::object& number : ToItems(value, path, expected)) item(number);
  }
  span_ = copy_;
}

Numbers::Numbers(nb::handle value, const FieldPath& path, size_t count) : Numbers(value, path) {
  if (size() != count)
    ThrowValue(path, fmt::format("must be {}, got {}",
                                 Counted(static_cast<int64_t>(count), "number"), size()));
}

std::vector<double> ToMatrix(nb::handle value, const FieldPath& path, size_t rows, size_t cols) {
  using Array = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
  Array array;
  if (nb::try_cast(value, array, /*convert=*/false) && array.shape(0) == rows &&
      array.shape(1) == cols)
    return {array.data(), array.data() + rows * cols};
  const std::vector<nb::object> items = ToItems(value, path, "a matrix");
  if (items.size() != rows) {
    ThrowValue(path, fmt::format("must be a {}x{} matrix, got {}", rows, cols,
                                 Counted(std::ssize(items), "row")));
  }
  std::vector<double> out;
  out.reserve(rows * cols);
  for (size_t i = 0; i < rows; ++i) {
    const FieldPath row(path, static_cast<Py_ssize_t>(i));
    const Numbers numbers(items[i], row, cols);
    out.insert(out.end(), numbers.span().begin(), numbers.span().end());
  }
  return out;
}

nb::object NumberView(double* data, size_t count, nb::handle owner) {
  return nb::ndarray<nb::numpy, double, nb::ndim<1>>(data, {count}, owner)
      .cast(nb::rv_policy::reference);
}

nb::object NumberView(int* data, size_t count, nb::handle owner) {
  return nb::ndarray<nb::numpy, int, nb::ndim<1>>(data, {count}, owner)
      .cast(nb::rv_policy::reference);
}

nb::object ReadOnlyView(const double* data, std::initializer_list<size_t> shape, nb::handle owner) {
  return nb::ndarray<nb::numpy, const double>(data, shape, owner).cast(nb::rv_policy::reference);
}

nb::object NumberCopy(std::span<const double> numbers, std::initializer_list<size_t> shape) {
  return NewArray(numbers, shape);
}

nb::object NumberCopy(std::span<const double> numbers) { return NewRow(numbers); }

nb::object Keeper(std::shared_ptr<void> object) {
  return nb::capsule(new std::shared_ptr<void>(std::move(object)),
                     [](void* p) noexcept { delete static_cast<std::shared_ptr<void>*>(p); });
}

}  // namespace robocell::python
