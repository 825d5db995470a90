// StartConfig: `start:` of a run file: where the robot's base stands around what an episode is
// about, and what has to hold before the episode begins. It is the same for all tasks; what the
// stages do with it is in task/start_sampler.h and task/base_placement.h.
//
//   start: {base_distance: [0.3, 0.6], base_height_offset: -0.25, visible_from: [exo_camera]}
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

struct StartConfig {
  std::optional<Vec2> base_distance = {};
  std::optional<double> base_height_offset = {};
  std::optional<Vec2> base_height_noise = {};
  double base_facing_noise = 0.35;
  double base_clearance = 0.01;
  NameList visible_from = {};
  double visible_share = 0.5;

  static constexpr const char* kTypeName = "StartConfig";
  template <class V>
  static void Fields(V&& v) {
    v("base_distance", &StartConfig::base_distance,
      "Horizontal distance from the robot's base to the first object of the task, metres, smallest "
      "and largest. Unset: the task's own range, which is [0.3, 0.6] unless the task says more.",
      Bound::kNonNegative);
    v("base_height_offset", &StartConfig::base_height_offset,
      "Height of the base's bottom above that object, metres. Unset: the task's own, else 0.");
    v("base_height_noise", &StartConfig::base_height_noise,
      "Added to the height, uniform between these, metres. Unset: the task's own, else [0, 0].");
    v("base_facing_noise", &StartConfig::base_facing_noise,
      "How far the base may be turned away from the object, radians, uniform between minus and "
      "plus this.",
      Bound::kNonNegative);
    v("base_clearance", &StartConfig::base_clearance,
      "The robot stands at least so far from everything else, metres.", Bound::kNonNegative);
    v("visible_from", &StartConfig::visible_from,
      "Cameras that have to see the object when an episode begins, named as in cameras.streams; "
      "none unless set.");
    v("visible_share", &StartConfig::visible_share,
      "The share of the object that each of visible_from has to see in its image, unhidden.",
      Bound::kFraction);
  }
  void Validate(Problems& problems) const;
};

// For messages about a field that stands elsewhere: " It is a field of `start`: ..."; "" for a name
// that is none of its fields.
std::string StartHint(const std::string& name);

}  // namespace robocell
