// Configurations that are passed to a filter in one call. For the solvers of this folder.
#pragma once

#include <span>
#include <vector>

#include "robocell/kinematics/ik.h"

namespace robocell::internal {

class FilterCall {
 public:
  void Add(const JointVector& q) {
    rows_.insert(rows_.end(), q.begin(), q.end());
    ++count_;
  }
  // Returns 1 for each that is kept, else 0, in the order of adding, and clears the list.
  std::span<const uint8_t> Ask(const IkFilter& filter) {
    keep_.assign(count_, 0);
    if (count_ > 0) filter(rows_, count_, keep_);
    rows_.clear();
    count_ = 0;
    return keep_;
  }

 private:
  std::vector<double> rows_;
  std::vector<uint8_t> keep_;
  int count_ = 0;
};

}  // namespace robocell::internal
