// Converts values from and to Python: numbers, texts, arrays. Errors contain the name of the field
// or argument.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bindings.h"
#include "robocell/math/pose.h"

namespace robocell::python {

// The path of a value: "robots[0].pos". A chain on the stack; the text is made for messages only.
struct FieldPath {
  const FieldPath* parent = nullptr;
  std::string_view name = {};
  Py_ssize_t index = -1;

  FieldPath(std::string_view name) : name(name) {}
  FieldPath(const FieldPath& parent, std::string_view name) : parent(&parent), name(name) {}
  FieldPath(const FieldPath& parent, Py_ssize_t index) : parent(&parent), index(index) {}
  FieldPath(const FieldPath&) = delete;
  FieldPath& operator=(const FieldPath&) = delete;

  std::string text() const;
};

// "a RobotSpec", "an Edit".
std::string WithArticle(std::string_view noun);
std::string TypeName(nb::handle value);

// TypeError "<path> must be <expected>, got <type>".
[[noreturn]] void ThrowType(const FieldPath& path, const std::string& expected, nb::handle got);
// ArgumentError "<path> <problem>".
[[noreturn]] void ThrowValue(const FieldPath& path, const std::string& problem);

bool ToBool(nb::handle value, const FieldPath& path);
int64_t ToInt(nb::handle value, const FieldPath& path, int64_t lowest = INT64_MIN,
              int64_t largest = INT64_MAX);
double ToDouble(nb::handle value, const FieldPath& path);
// A text, or a path object.
std::string ToText(nb::handle value, const FieldPath& path);
bool IsText(nb::handle value);
// A key of the mapping that `path` names.
std::string ToKey(nb::handle key, const FieldPath& path);
// The items of any iterable but a text; `expected` as in "a list of names".
std::vector<nb::object> ToItems(nb::handle value, const FieldPath& path,
                                const std::string& expected);
// A single text or any iterable of texts.
std::vector<std::string> ToTexts(nb::handle value, const FieldPath& path);

// Numbers from anything that holds them: arrays (not copied when they are contiguous float64),
// sequences, PyKDL's vectors and JntArray. Valid as long as the object given is.
class Numbers {
 public:
  Numbers(nb::handle value, const FieldPath& path);
  // ArgumentError "<path> must be 3 numbers, got 2" unless there are so many.
  Numbers(nb::handle value, const FieldPath& path, size_t count);

  std::span<const double> span() const { return span_; }
  operator std::span<const double>() const { return span_; }
  double operator[](size_t i) const { return span_[i]; }
  size_t size() const { return span_.size(); }

 private:
  bool Borrow(nb::handle value);

  nb::object array_;
  std::vector<double> copy_;
  std::span<const double> span_;
};

// A matrix, row by row: (rows, cols) numbers from an array or nested sequences.
std::vector<double> ToMatrix(nb::handle value, const FieldPath& path, size_t rows, size_t cols);

// NumPy arrays. A view writes through and keeps `owner` alive; a copy owns its numbers.
nb::object NumberView(double* data, size_t count, nb::handle owner);
nb::object NumberView(int* data, size_t count, nb::handle owner);
nb::object ReadOnlyView(const double* data, std::initializer_list<size_t> shape, nb::handle owner);
nb::object NumberCopy(std::span<const double> numbers);
nb::object NumberCopy(std::span<const double> numbers, std::initializer_list<size_t> shape);
// A PyKDL.Frame.
nb::object ToKdl(const Pose& pose);
// PyKDL; ImportError with the install line when it is missing.
nb::object ImportPyKdl();
// Keeps a C++ object alive for views on it.
nb::object Keeper(std::shared_ptr<void> object);

}  // namespace robocell::python
