#include "arrays.h"

#include <fmt/ranges.h>

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

std::vector<double> ToDoubles(nb::handle value, const char* what, std::vector<size_t>& shape) {
  nb::module_ numpy = nb::module_::import_("numpy");
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
  const auto view = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(array);
  if (view.ndim() == 0) refuse();
  shape.clear();
  for (size_t i = 0; i < view.ndim(); ++i) shape.push_back(view.shape(i));
  return {view.data(), view.data() + view.size()};
}

std::vector<double> ToDoubles(nb::handle value, const char* what) {
  std::vector<size_t> shape;
  return ToDoubles(value, what, shape);
}

std::vector<double> ToRow(nb::handle value, const char* what) {
  std::vector<size_t> shape;
  std::vector<double> row = ToDoubles(value, what, shape);
  if (shape.size() == 1) return row;
  throw ArgumentError(fmt::format("{} must be a row of numbers, got an array of shape ({})", what,
                                  fmt::join(shape, ", ")));
}

}  // namespace robocell::python
