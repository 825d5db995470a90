// Private to robot: the addresses of a group's numbers in one of the engine's arrays.
//
// They are nearly always contiguous, which is detected once; then they are copied without looking
// up each.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "robocell/base/small_arrays.h"

namespace robocell {

class Addresses {
 public:
  void clear() {
    list_.clear();
    in_a_row_ = true;
  }
  // Adds the next addresses.
  void Add(int first, int count = 1) {
    for (int k = 0; k < count; ++k) {
      if (list_.empty()) first_ = first;
      in_a_row_ &= list_.empty() || first + k == list_.back() + 1;
      list_.push_back(first + k);
    }
  }

  const std::vector<int>& list() const { return list_; }
  size_t size() const { return list_.size(); }
  int operator[](size_t i) const { return list_[i]; }
  // Returns the address of the first if the others follow it contiguously, else null.
  const double* InARow(const double* array) const {
    return in_a_row_ && !list_.empty() ? array + first_ : nullptr;
  }

  // `out` has the same size.
  void Gather(const double* array, std::span<double> out) const {
    if (const double* from = InARow(array)) return CopySmall(from, out.size_bytes(), out.data());
    for (size_t i = 0; i < out.size(); ++i) out[i] = array[list_[i]];
  }
  // `values` has the same size.
  void Scatter(std::span<const double> values, double* array) const {
    if (in_a_row_ && !list_.empty())
      return CopySmall(values.data(), values.size_bytes(), array + first_);
    for (size_t i = 0; i < values.size(); ++i) array[list_[i]] = values[i];
  }

 private:
  std::vector<int> list_;
  int first_ = -1;  // first address; stored here, not behind a pointer
  bool in_a_row_ = true;
};

}  // namespace robocell
