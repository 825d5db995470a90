// Handles commands beyond a limit: uses the nearest value inside, and logs the first one. Not for
// NaN and wrong sizes, which are rejected (RequireValues).
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "robocell/robot/move_group.h"

namespace robocell {

class BeyondLimits {
 public:
  // Returns `value` clamped to `range`; NaN stays NaN. `what()` names the command and is called at
  // most once in the life of this object. No allocation inside the range.
  template <class What>
  double Clamp(double value, const Interval& range, const What& what) {
    Watch(value, range, what);
    return std::clamp(value, range.lower, range.upper);
  }

  // Only logs, for values that other code clips.
  template <class What>
  void Watch(double value, const Interval& range, const What& what) {
    if (warned_ || (value >= range.lower - kSlack && value <= range.upper + kSlack)) return;
    if (std::isnan(value)) return;
    warned_ = true;
    Warn(what(), value, range);
  }
  bool warned() const { return warned_; }

 private:
  static constexpr double kSlack = 1e-3;  // allows for rounding and small overshoot

  static void Warn(const std::string& what, double value, const Interval& range);

  bool warned_ = false;
};

}  // namespace robocell
