// The fields of the tasks that drive: navigate (navigate_task.h).
#pragma once

#include <string>

#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"

namespace robocell {

struct NavigateTaskConfig {
  std::string to = {};
  double within = 1.0;
  double facing = 0.5;
  double least_way = 1.0;
  double speed = 0.6;
  double turn_speed = 1.2;
  bool open_doors = true;

  static constexpr const char* kKind = "navigate";
  static constexpr const char* kTypeName = "NavigateTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = NavigateTaskConfig;
    v("to", &T::to,
      "Where the robot goes: a room or an object of the scene by its name, or any room of this "
      "category. Unset: drawn from the rooms and from the objects whose words mean one object "
      "alone.");
    v("within", &T::within,
      "Success at an object: the base's origin is within this horizontal distance of the object's "
      "nearest part, metres.",
      Bound::kPositive);
    v("facing", &T::facing,
      "Success at an object: the base points to its middle within plus and minus this angle, "
      "radians.",
      Bound::kPositive);
    v("least_way", &T::least_way, "Shortest way from the start, metres; shorter ones are refused.",
      Bound::kNonNegative);
    v("speed", &T::speed, "Largest speed of the scripted expert's drives, m/s.", Bound::kPositive);
    v("turn_speed", &T::turn_speed, "Largest speed of its turns, rad/s.", Bound::kPositive);
    v("open_doors", &T::open_doors,
      "Whether doors that are at least 1.5 m high stand open at the start.");
  }
};

}  // namespace robocell
