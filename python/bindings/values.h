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

// The path of a value: "robots[0].pos". A chain on the stack; its text is only made for messages.
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

// Returns the noun with its article: "a RobotSpec", "an Edit".
std::string WithArticle(std::string_view noun);
std::string TypeName(nb::handle value);

// Throws TypeError "<path> must be <expected>, got <type>".
[[noreturn]] void ThrowType(const FieldPath& path, const std::string& expected, nb::handle got);
// Throws ArgumentError "<path> <problem>".
[[noreturn]] void ThrowValue(const FieldPath& path, const std::string& problem);

bool ToBool(nb::handle value, const FieldPath& path);
int64_t ToInt(nb::handle value, const FieldPath& path, int64_t lowest = INT64_MIN,
              int64_t largest = INT64_MAX);
double ToDouble(nb::handle value, const FieldPath& path);
// Accepts a text, or a path object.
std::string ToText(nb::handle value, const FieldPath& path);
bool IsText(nb::handle value);
// Converts a key of the mapping that `path` names.
std::string ToKey(nb::handle key, const FieldPath& path);
// Returns the items of any iterable except a text; `expected` as in "a list of names".
std::vector<nb::object> ToItems(nb::handle value, const FieldPath& path,
                                const std::string& expected);
// Accepts a single text or any iterable of texts.
std::vector<std::string> ToTexts(nb::handle value, const FieldPath& path);

// Numbers from anything that holds them: arrays (contiguous float64 is not copied), sequences,
// PyKDL's vectors and JntArray. Valid as long as the given object.
class Numbers {
 public:
  Numbers(nb::handle value, const FieldPath& path, const char* expected = "a list of numbers");
  // Throws ArgumentError "<path> must be 3 numbers, got 2" unless there are `count`.
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

// Converts a matrix, row by row: (rows, cols) numbers from an array or nested sequences.
std::vector<double> ToMatrix(nb::handle value, const FieldPath& path, size_t rows, size_t cols);

// Return NumPy arrays. A view writes through and keeps `owner` alive; a copy owns its numbers.
nb::object NumberView(double* data, size_t count, nb::handle owner);
nb::object NumberView(int* data, size_t count, nb::handle owner);
nb::object ReadOnlyView(const double* data, std::initializer_list<size_t> shape, nb::handle owner);
nb::object NumberCopy(std::span<const double> numbers);
nb::object NumberCopy(std::span<const double> numbers, std::initializer_list<size_t> shape);
// Returns a PyKDL.Frame.
nb::object ToKdl(const Pose& pose);
// Returns PyKDL. Raises ImportError with the install command if it is missing.
nb::object ImportPyKdl();
// Keeps a C++ object alive for views on it.
nb::object Keeper(std::shared_ptr<void> object);

}  // namespace robocell::python
