#include "robocell/robot/joint_limits.h"

#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {

std::vector<Interval> CheckedJointPosLimits(const MoveGroup& group) {
  std::vector<Interval> limits = group.joint_pos_limits();
  if (limits.size() != static_cast<size_t>(group.nq())) {
    throw ArgumentError(
        fmt::format("{}: joint_pos_limits has {} interval(s), expected {}, one for each "
                    "joint position (infinite where there is no limit)",
                    group.place(), limits.size(), group.nq()));
  }
  for (size_t i = 0; i < limits.size(); ++i) {
    if (limits[i].lower <= limits[i].upper) continue;
    throw ArgumentError(
        fmt::format("{}: joint_pos_limits[{}] is [{}, {}], expected [smallest, largest]",
                    group.place(), i, limits[i].lower, limits[i].upper));
  }
  return limits;
}

}  // namespace robocell
