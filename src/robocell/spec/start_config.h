// StartConfig: `start:` of a run file: the places of objects and of the robot's base at the start
// of an episode, and its conditions. It is the same for all tasks; the stages in
// task/start_sampler.h and task/base_placement.h use it.
//
//   start: {base_distance: [0.3, 0.6], base_height_offset: -0.25, visible_from: [exo_camera]}
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/object_place.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/start_camera.h"
#include "robocell/spec/types.h"

namespace robocell {

struct StartConfig {
  std::optional<Vec2> base_distance = {};
  std::optional<double> base_height_offset = {};
  std::optional<Vec2> base_height_noise = {};
  double base_facing_noise = 0.35;
  double base_clearance = 0.01;
  double base_separation = 0;
  bool base_blocks_doors = false;
  NameList visible_from = {};
  double visible_share = 0.5;
  Map<ObjectPlace> places = {};
  Map<StartCamera> cameras = {};

  static constexpr const char* kTypeName = "StartConfig";
  template <class V>
  static void Fields(V&& v) {
    v("base_distance", &StartConfig::base_distance,
      "Horizontal distance from the robot's base to the first object of the task, metres, smallest "
      "and largest. Unset: the task's own range, else [0.3, 0.6].",
      Bound::kNonNegative);
    v("base_height_offset", &StartConfig::base_height_offset,
      "Height of the base's bottom above that object, metres. Unset: the task's own, else 0.");
    v("base_height_noise", &StartConfig::base_height_noise,
      "Random offset of that height, uniform between these, metres. Unset: the task's own, else "
      "[0, 0].");
    v("base_facing_noise", &StartConfig::base_facing_noise,
      "Random angle by which the base is turned away from the object, uniform between minus and "
      "plus this, radians.",
      Bound::kNonNegative);
    v("base_clearance", &StartConfig::base_clearance,
      "Smallest distance between the robot and everything else, metres.", Bound::kNonNegative);
    v("base_separation", &StartConfig::base_separation,
      "Smallest horizontal distance between a place of the base that was rejected and the next one "
      "that is tried for the same start, metres.",
      Bound::kNonNegative);
    v("base_blocks_doors", &StartConfig::base_blocks_doors,
      "Whether the robot at its start may stand in the swing of a door that is at least 1.5 m "
      "high.");
    v("visible_from", &StartConfig::visible_from,
      "Cameras that must see the object when an episode begins, named as in cameras.streams. "
      "Unset: none.");
    v("visible_share", &StartConfig::visible_share,
      "Share of the object that each camera of visible_from must see unhidden.", Bound::kFraction);
    v("places", &StartConfig::places,
      "Objects by name or kind, and where each starts in relation to another object or a body of "
      "the scene. Others lie on the support. Unset: the task's own.");
    v("cameras", &StartConfig::cameras,
      "Cameras that each start places, by their names in the scene; `cameras.streams` has their "
      "images.");
  }
  void Validate(Problems& problems) const;
};

// Returns a hint for messages about a misplaced field: " It is a field of `start`: ..."; "" for a
// name that is not one of its fields.
std::string StartHint(const std::string& name);

}  // namespace robocell
