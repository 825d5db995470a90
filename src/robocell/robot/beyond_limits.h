// What happens to commands beyond a limit: the nearest value inside is used, and the first time the
// log says so. Not for NaN and wrong sizes, which are refused (RequireValues).
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "robocell/robot/move_group.h"

namespace robocell {

class BeyondLimits {
 public:
  // `value` inside `range`; NaN stays NaN. `what()` names what is commanded and is called at most
  // once in the life of this object. No allocation inside the range.
  template <class What>
  double Clamp(double value, const Interval& range, const What& what) {
    Watch(value, range, what);
    return std::clamp(value, range.lower, range.upper);
  }

  // Only tells, for what something else cuts off.
  template <class What>
  void Watch(double value, const Interval& range, const What& what) {
    if (told_ || (value >= range.lower - kSlack && value <= range.upper + kSlack)) return;
    if (std::isnan(value)) return;
    told_ = true;
    Tell(what(), value, range);
  }
  bool told() const { return told_; }

 private:
  static constexpr double kSlack = 1e-3;  // what rounding and small overshoot may amount to

  static void Tell(const std::string& what, double value, const Interval& range);

  bool told_ = false;
};

}  // namespace robocell
