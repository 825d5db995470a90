// The fields of the built-in kinds of tasks, pick and pick_and_place, in runs and environments. The
// scene's own object and goal are named; otherwise objects of the catalogue are drawn.
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/types.h"

namespace robocell {

// A lift of 5 cm cannot be mistaken: an object that tips over or that closing fingers push rises by
// one or two centimetres, and scripted experts lift by ten.
inline constexpr double kLiftHeight = 0.05;

// What `arm` is where any arm may act.
inline constexpr const char* kAnyArm = "any";

// Visits the fields that every task has which picks an object up: a named object and the lift,
// followed by drawn objects.
template <class T, class V>
void PickedObjectFields(V&& v) {
  v("object", &T::object,
    "The object, by its id in an environment's root_frame_objects, or by its name in a run's "
    "scenes. Unset: drawn from `objects`.");
  v("spread", &T::spread,
    "Random offset of `object` from its place, uniform between plus and minus these, along x and y "
    "of the root frame, metres.",
    Bound::kNonNegative);
  v("rotate", &T::rotate, "Also turn `object` by a random angle about z of the root frame.");
  v("refer", &T::refer,
    "Name the object in the instruction by what tells it from all others, as the robot sees them: "
    "`the red mug`, `the mug left of the laptop`. An object that no words single out has the name "
    "of "
    "its kind.");
  v("lift_height", &T::lift_height,
    "Success: the object is this far above its first height, metres, and only robots hold it.",
    Bound::kPositive);
  v("arm", &T::arm,
    "In a run, the arm that acts, of a robot with several: the name of a group of kind arm, or "
    "any: in "
    "each episode the nearest one that can. The others hold still. Unset: any.");
}
template <class T, class V>
void DrawnObjectFields(V&& v) {
  v("objects", &T::objects,
    "Without `object`: kinds and categories of the catalogue that it is drawn from. Unset: the "
    "default kinds, in an environment three of them.");
}

struct PickTaskConfig {
  std::string object = {};
  Vec2 spread = {0, 0};
  bool rotate = true;
  bool refer = false;
  double lift_height = kLiftHeight;
  std::string arm = {};
  NameList objects = {};

  static constexpr const char* kKind = "pick";
  static constexpr const char* kTypeName = "PickTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = PickTaskConfig;
    PickedObjectFields<T>(v);
    DrawnObjectFields<T>(v);
  }
};

struct PickAndPlaceTaskConfig {
  std::string object = {};
  Vec2 spread = {0, 0};
  bool rotate = true;
  bool refer = false;
  double lift_height = kLiftHeight;
  std::string arm = {};
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
      "Goal of the object's root, metres, in the root frame, or with goal_object in the frame of "
      "that object's root. Unset with goal_object: on top of it, in the middle.");
    v("goal_object", &T::goal_object,
      "The object that carries the goal, named as `object`. The goal moves with it.");
    v("goal_spread", &T::goal_spread,
      "Random offset of the goal, or of goal_object, from its place, as `spread`.",
      Bound::kNonNegative);
    v("goal_tolerance", &T::goal_tolerance,
      "Success: the object was lifted and then released, and rests within this distance of the "
      "goal, metres.",
      Bound::kPositive);
    v("goal_distance", &T::goal_distance,
      "Smallest horizontal distance between object and goal when an episode begins, metres.",
      Bound::kNonNegative);
    v("goals", &T::goals,
      "Without `goal` and `goal_object`: kinds of objects that the goal is drawn from, of the "
      "catalogue, also by category, or built-in equipment with a free joint. Unset: `tray`.");
    DrawnObjectFields<T>(v);
  }
};

class TaskSpec;

// The common fields of both kinds in a run.
struct PickRun {
  std::string object = {};
  NameList objects;
  double lift_height;
  std::string arm = {};
};
// Returns the fields of a task of either kind; unset for other tasks.
std::optional<PickRun> PickRunOf(const TaskSpec& task);

}  // namespace robocell
