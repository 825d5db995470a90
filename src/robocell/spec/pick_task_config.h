// The fields of the built-in kinds of tasks, pick and pick_and_place. What the tasks do with them
// is in task/pick_task.h and task/pick_and_place_task.h.
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/types.h"

namespace robocell {

// A lift of 5 cm cannot be mistaken: an object that is tipped over or nudged by closing fingers
// rises by one or two centimetres, and scripted experts lift by ten.
inline constexpr double kLiftHeight = 0.05;

// Visits the fields that every task has which picks an object up: those of environments and the
// lift, then those of runs.
template <class T, class V>
void PickedObjectFields(V&& v) {
  v("object", &T::object,
    "The object, by its id in root_frame_objects of an environment. Unset in a run, whose objects "
    "are of the kinds in `objects`.");
  v("spread", &T::spread,
    "How far `object` lies from its place, uniform between plus and minus these, along x and y of "
    "the root frame, metres.",
    Bound::kNonNegative);
  v("rotate", &T::rotate, "Turn `object` by any angle about the root frame's z too.");
  v("lift_height", &T::lift_height,
    "Success: lifted this far above where the episode began, metres, and held only by robots.",
    Bound::kPositive);
}
template <class T, class V>
void PickRunFields(V&& v) {
  v("objects", &T::objects,
    "Of runs: kinds of objects, by their names in the catalogue; all of them unless set.");
}

struct PickTaskConfig {
  std::string object = {};
  Vec2 spread = {0, 0};
  bool rotate = true;
  double lift_height = kLiftHeight;
  NameList objects = {};

  static constexpr const char* kKind = "pick";
  static constexpr const char* kTypeName = "PickTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = PickTaskConfig;
    PickedObjectFields<T>(v);
    PickRunFields<T>(v);
  }
};

struct PickAndPlaceTaskConfig {
  std::string object = {};
  Vec2 spread = {0, 0};
  bool rotate = true;
  double lift_height = kLiftHeight;
  std::optional<Vec3> goal = {};
  std::string goal_object = {};
  Vec2 goal_spread = {0, 0};
  double goal_tolerance = 0.03;
  double goal_distance = 0.1;
  NameList objects = {};
  NameList goals = {};

  static constexpr const char* kKind = "pick_and_place";
  static constexpr const char* kTypeName = "PickAndPlaceTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = PickAndPlaceTaskConfig;
    PickedObjectFields<T>(v);
    v("goal", &T::goal,
      "Where the object's root is to rest, metres, in the root frame, or with goal_object in the "
      "frame of that object's root. Unset with goal_object: on top of it, in the middle.");
    v("goal_object", &T::goal_object,
      "The goal is on this object, by its id in root_frame_objects, wherever it is.");
    v("goal_spread", &T::goal_spread,
      "How far the goal, or goal_object, lies from its place, as `spread`.", Bound::kNonNegative);
    v("goal_tolerance", &T::goal_tolerance,
      "Success: released and at rest so near to the goal, metres, after it was lifted.",
      Bound::kPositive);
    v("goal_distance", &T::goal_distance,
      "Episodes begin with the object at least so far from the goal along the ground, metres.",
      Bound::kNonNegative);
    v("goals", &T::goals,
      "Of runs: what objects are put on, kinds of the catalogue or built-in equipment with a free "
      "joint; `tray` unless set.");
    PickRunFields<T>(v);
  }
};

class TaskSpec;

// What both kinds say of a run.
struct PickRun {
  NameList objects;
  double lift_height;
};
// Of a task of either kind; unset for others.
std::optional<PickRun> PickRunOf(const TaskSpec& task);

}  // namespace robocell
