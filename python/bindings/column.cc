#include "column.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "arrays.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell::python {

using namespace nb::literals;

namespace {

nb::object Numpy(const char* function) { return nb::module_::import_("numpy").attr(function); }

template <class T>
nb::object ReadAs(const Column& column, const RowRange& range, const std::vector<size_t>& shape) {
  return NewArray(column.episode->Read<T>(column.info->spec.name, range), shape);
}

bool IsConstant(const Column& column) { return column.info->table.empty(); }

// Returns the row of an index, which may count from the end.
int64_t RowAt(const Column& column, int64_t index) {
  const int64_t rows = column.info->rows;
  if (index >= -rows && index < rows) return index < 0 ? index + rows : index;
  throw nb::index_error(fmt::format("{}: no row {} of '{}', it has {}",
                                    column.episode->folder().string(), index,
                                    column.info->spec.name, Counted(rows, "row"))
                            .c_str());
}

// Rows to read, and the selected ones among them.
struct Chosen {
  int64_t first = 0;
  int64_t count = 0;
  nb::object among;  // an index into the rows that are read
};

Chosen RowsOfSlice(const Column& column, nb::handle slice) {
  Py_ssize_t start = 0, stop = 0, step = 1;
  if (PySlice_Unpack(slice.ptr(), &start, &stop, &step) < 0) throw nb::python_error();
  const int64_t count = PySlice_AdjustIndices(column.info->rows, &start, &stop, step);
  nb::object among = nb::slice(nb::none(), nb::none(), nb::int_(step));
  if (count == 0) return {0, 0, among};
  const int64_t last = start + (count - 1) * step;
  const auto [low, high] = std::minmax<int64_t>(start, last);
  return {low, high - low + 1, among};
}

// Selects row numbers, or truth values for each row: reads from the first to the last of them.
Chosen RowsOfArray(const Column& column, nb::handle key) {
  nb::object wanted = Numpy("asarray")(key);
  const auto size = nb::cast<int64_t>(wanted.attr("size"));
  const auto kind = nb::cast<std::string>(wanted.attr("dtype").attr("kind"));
  if (kind == "b") {
    if (size != column.info->rows) {
      throw nb::index_error(fmt::format("{} for the {} of '{}'", Counted(size, "truth value"),
                                        Counted(column.info->rows, "row"), column.info->spec.name)
                                .c_str());
    }
    wanted = Numpy("flatnonzero")(wanted);
  } else if (size > 0 && kind != "i" && kind != "u") {
    throw nb::type_error(
        fmt::format("rows of '{}' are chosen by integers, slices and arrays of integers or truth "
                    "values; its properties are attributes, such as .units",
                    column.info->spec.name)
            .c_str());
  }
  auto numbers = nb::cast<std::vector<int64_t>>(wanted.attr("ravel")().attr("tolist")());
  for (int64_t& row : numbers) row = RowAt(column, row);
  const auto index = [&] {
    const nb::object flat = NewArray(std::span<const int64_t>(numbers), {numbers.size()});
    return nb::object(flat.attr("reshape")(wanted.attr("shape")));
  };
  if (numbers.empty()) return {0, 0, index()};
  const auto [least, most] = std::ranges::minmax(numbers);
  for (int64_t& row : numbers) row -= least;
  return {least, most - least + 1, index()};
}

// Excludes arrays, although numpy's have an __index__ too, and truth values.
bool IsInteger(nb::handle key) {
  return PyIndex_Check(key.ptr()) && !PyBool_Check(key.ptr()) && !nb::hasattr(key, "__len__");
}

Chosen RowsOf(const Column& column, nb::handle key) {
  if (key.is(nb::ellipsis())) return {0, column.info->rows, nb::borrow(key)};
  if (nb::isinstance<nb::slice>(key)) return RowsOfSlice(column, key);
  if (!IsInteger(key)) return RowsOfArray(column, key);
  const Py_ssize_t index = PyNumber_AsSsize_t(key.ptr(), PyExc_IndexError);
  if (index == -1 && PyErr_Occurred() != nullptr) throw nb::python_error();
  return {RowAt(column, index), 1, nb::int_(0)};
}

nb::object Item(const Column& column, nb::handle key) {
  if (IsConstant(column)) return ReadRows(column, 0, std::nullopt)[key];
  if (!nb::isinstance<nb::tuple>(key)) {
    const Chosen rows = RowsOf(column, key);
    return ReadRows(column, rows.first, rows.count)[rows.among];
  }
  if (nb::len(key) == 0) return ReadRows(column, 0, std::nullopt);
  const Chosen rows = RowsOf(column, nb::borrow<nb::tuple>(key)[0]);
  const nb::object inner = key[nb::slice(nb::int_(1), nb::none(), nb::none())];
  return ReadRows(column, rows.first, rows.count)[nb::object(nb::make_tuple(rows.among)) + inner];
}

nb::object AsArray(const Column& column, nb::handle dtype, nb::handle copy) {
  const nb::object all = ReadRows(column, 0, std::nullopt);
  if (copy.is(nb::bool_(false)))
    throw nb::value_error("an array of a column is always a copy: its rows are in a file");
  return dtype.is_none() ? all : all.attr("astype")(dtype);
}

std::string Repr(const Column& column) {
  const ColumnSpec& spec = column.info->spec;
  std::string text = fmt::format("<Column '{}': {}", spec.name, NameOf(spec.type));
  if (!spec.shape.empty()) text += fmt::format(" ({})", fmt::join(spec.shape, ", "));
  if (!spec.units.empty()) text += ", " + spec.units;
  return text + (IsConstant(column) ? ", constant>"
                                    : fmt::format(", {}>", Counted(column.info->rows, "row")));
}

}  // namespace

nb::object ReadRows(const Column& column, int64_t first, std::optional<int64_t> count) {
  const ColumnInfo& info = *column.info;
  const bool constant = IsConstant(column);
  const RowRange range = constant ? RowRange{} : RowRange{first, count};
  std::vector<size_t> shape;
  if (!constant) shape.push_back(static_cast<size_t>(count.value_or(info.rows - first)));
  for (const int64_t n : info.spec.shape) shape.push_back(static_cast<size_t>(n));
  switch (info.spec.type) {
    case ColumnType::kFloat64:
      return ReadAs<double>(column, range, shape);
    case ColumnType::kFloat32:
      return ReadAs<float>(column, range, shape);
    case ColumnType::kInt64:
      return ReadAs<int64_t>(column, range, shape);
    case ColumnType::kInt32:
      return ReadAs<int32_t>(column, range, shape);
    case ColumnType::kUint8:
      return ReadAs<uint8_t>(column, range, shape);
    case ColumnType::kBool:
      break;
  }
  const std::string& name = info.spec.name;
  std::vector<uint8_t> values(column.episode->ValueCount(name, range));
  column.episode->ReadBytes(name, range, ColumnType::kBool,
                            std::as_writable_bytes(std::span(values)));
  return NewArray<uint8_t, bool>(std::move(values), shape);
}

void BindColumn(nb::module_& m) {
  const auto field = [](auto get) { return [get](const Column& c) { return get(*c.info); }; };
  nb::class_<Column>(
      m, "Column",
      "A column of an episode: its attributes and its rows.\n\nRows are read only when indexed: "
      "`column[10:20]` reads ten rows from the disk, `column[:]` all of them. Indices are as in "
      "numpy: an integer, a slice, an array of integers or of booleans, and further indices within "
      "a row (`column[10:20, 2]`). A constant has no rows and is indexed as an array.")
      .def_prop_ro("name", field([](const ColumnInfo& i) { return i.spec.name; }),
                   "The name that `episode[name]` takes.")
      .def_prop_ro("dtype",
                   field([](const ColumnInfo& i) { return std::string(NameOf(i.spec.type)); }),
                   "The type of the numbers in numpy's terms: 'float64', 'bool'.")
      .def_prop_ro("row_shape",
                   field([](const ColumnInfo& i) { return nb::tuple(nb::cast(i.spec.shape)); }),
                   nb::sig("def row_shape(self) -> tuple[int, ...]"),
                   "The shape of one row; () for a single number.")
      .def_prop_ro(
          "shape",
          [](const Column& c) {
            std::vector<int64_t> shape = c.info->spec.shape;
            if (!IsConstant(c)) shape.insert(shape.begin(), c.info->rows);
            return nb::tuple(nb::cast(shape));
          },
          nb::sig("def shape(self) -> tuple[int, ...]"),
          "The shape of the whole array: (rows, ...), or of the constant.")
      .def_prop_ro("units", field([](const ColumnInfo& i) { return i.spec.units; }),
                   "The unit, 'rad', or one for each component, 'm, 1'.")
      .def_prop_ro("frame", field([](const ColumnInfo& i) { return i.spec.frame; }),
                   "The frame that the numbers are expressed in: 'world'.")
      .def_prop_ro("names", field([](const ColumnInfo& i) { return i.spec.names; }),
                   "The names of the components along the last axis.")
      .def_prop_ro("values", field([](const ColumnInfo& i) { return i.spec.values; }),
                   "The names of 0, 1, ... for integers with a meaning.")
      .def_prop_ro("description", field([](const ColumnInfo& i) { return i.spec.description; }),
                   "A sentence, if the name is not enough.")
      .def_prop_ro("table", field([](const ColumnInfo& i) { return i.table; }),
                   "The table of the column, 'steps'; '' for a constant.")
      .def_prop_ro("rows", field([](const ColumnInfo& i) { return i.rows; }),
                   "The number of rows; 0 for a constant.")
      .def("__len__",
           [](const Column& c) {
             if (!IsConstant(c)) return c.info->rows;
             if (c.info->spec.shape.empty()) throw nb::type_error("a constant number has no len()");
             return c.info->spec.shape[0];
           })
      .def("__getitem__", &Item, "key"_a,
           nb::sig("def __getitem__(self, key: typing.Any) -> typing.Any"))
      .def(
          "__iter__", [](const Column& c) { return nb::iter(ReadRows(c, 0, std::nullopt)); },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[typing.Any]"))
      .def("__array__", &AsArray, "dtype"_a = nb::none(), "copy"_a = nb::none(),
           nb::sig("def __array__(self, dtype: typing.Any = None, copy: bool | None = None) -> "
                   "numpy.typing.NDArray[typing.Any]"))
      .def("__repr__", &Repr);
}

}  // namespace robocell::python
