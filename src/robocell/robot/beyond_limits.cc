#include "robocell/robot/beyond_limits.h"

#include <fmt/format.h>

#include "robocell/base/log.h"

namespace robocell {

void BeyondLimits::Warn(const std::string& what, double value, const Interval& range) {
  LogWarn(
      fmt::format("{} is commanded to {:g}, beyond [{:g}, {:g}]; the nearest value inside is used "
                  "(reported once)",
                  what, value, range.lower, range.upper));
}

}  // namespace robocell
