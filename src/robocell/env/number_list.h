// Lists of numbers in one row, each preceded by its length: the format of states in files. Private
// to env.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"

namespace robocell::internal {

// Appends the length of a list and its numbers.
inline void PutList(std::span<const double> list, std::vector<double>& out) {
  out.push_back(static_cast<double>(list.size()));
  out.insert(out.end(), list.begin(), list.end());
}

// Reads numbers from the front. Throws ArgumentError for a row that is not `what`, for example "a
// state".
class NumberReader {
 public:
  NumberReader(std::span<const double> numbers, std::string what)
      : left_(numbers), what_(std::move(what)) {}

  std::span<const double> Take(size_t count) {
    if (count > left_.size())
      throw ArgumentError("these numbers are not a " + what_ + ": they end too early");
    const std::span<const double> taken = left_.first(count);
    left_ = left_.subspan(count);
    return taken;
  }
  size_t Count() {
    const double count = Take(1)[0];
    if (!(count >= 0 && count <= static_cast<double>(left_.size())))
      throw ArgumentError("these numbers are not a " + what_);
    return static_cast<size_t>(count);
  }
  std::vector<double> List() {
    const std::span<const double> list = Take(Count());
    return {list.begin(), list.end()};
  }
  void RequireEnd() const {
    if (!left_.empty()) throw ArgumentError("these numbers are more than a " + what_);
  }

 private:
  std::span<const double> left_;
  std::string what_;
};

}  // namespace robocell::internal
