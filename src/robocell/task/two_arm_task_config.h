// The fields of the built-in kinds of tasks for two arms: handover, carry (two_arm_tasks.h).
#pragma once

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/types.h"

namespace robocell {

struct HandoverTaskConfig {
  NameList objects = {};
  double hold_seconds = 0.3;

  static constexpr const char* kKind = "handover";
  static constexpr const char* kTypeName = "HandoverTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = HandoverTaskConfig;
    v("objects", &T::objects,
      "Kinds or categories of the catalogue that the object is drawn from. Unset: a bar, 0.2 m "
      "long.");
    v("hold_seconds", &T::hold_seconds,
      "Success: the second arm alone has held the object for this time, seconds.",
      Bound::kNonNegative);
  }
};

struct CarryTaskConfig {
  NameList objects = {};
  Vec2 distance = {0.08, 0.14};
  double most_tilt = 0.3;

  static constexpr const char* kKind = "carry";
  static constexpr const char* kTypeName = "CarryTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = CarryTaskConfig;
    v("objects", &T::objects,
      "Kinds or categories of the catalogue, or kinds of the equipment, that the object is drawn "
      "from. Unset: a case, 0.3 m wide.");
    v("distance", &T::distance,
      "Distance from the object to the middle of the region at the start, metres. The region is a "
      "marked circle with a radius of 0.04 m.",
      Bound::kNonNegative);
    v("most_tilt", &T::most_tilt,
      "Success: the object was never tilted by more than this on the way, radians.",
      Bound::kPositive);
  }
};

}  // namespace robocell
