// The fields of the built-in kinds of tasks whose goals are relations (scenes/relations.h).
#pragma once

#include <string>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

// Goals and starts written in a file.
struct RelationsTaskConfig {
  NameList objects = {};
  NameList start = {};
  NameList goal = {};
  std::string instruction = {};
  double hold_seconds = 0.3;

  static constexpr const char* kKind = "relations";
  static constexpr const char* kTypeName = "RelationsTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = RelationsTaskConfig;
    v("objects", &T::objects,
      "Objects that the task adds, each a kind or a category of the catalogue, or a kind of the "
      "equipment, or `name=kind`: [mug, red=box, tray].");
    v("start", &T::start,
      "Relations that hold at the start, as sentences: [\"mug on tray\", \"drawer open 0.5\"].");
    v("goal", &T::goal,
      "Relations of the goal, as sentences: success is when all hold and no robot touches their "
      "free objects, also those that others relate to, unless they are to be held.");
    v("instruction", &T::instruction, "The instruction. Unset: made from the goal.");
    v("hold_seconds", &T::hold_seconds, "Time for which the goal has to hold, seconds.",
      Bound::kNonNegative);
  }
  void Validate(Problems& problems) const;
};

struct StackTaskConfig {
  int cubes = 2;
  double edge = 0.04;

  static constexpr const char* kKind = "stack";
  static constexpr const char* kTypeName = "StackTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    v("cubes", &StackTaskConfig::cubes, "Number of cubes, 2 to 6.");
    v("edge", &StackTaskConfig::edge, "Length of their edges, metres.", Bound::kPositive);
  }
  void Validate(Problems& problems) const;
};

struct PlaceNextToTaskConfig {
  NameList objects = {};
  NameList references = {};
  double gap = 0.05;

  static constexpr const char* kKind = "place_next_to";
  static constexpr const char* kTypeName = "PlaceNextToTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = PlaceNextToTaskConfig;
    v("objects", &T::objects,
      "Kinds or categories of the catalogue that the object is drawn from. Unset: the default "
      "kinds.");
    v("references", &T::references,
      "Kinds of the catalogue and of equipment that the other object is drawn from. Unset: the "
      "default kinds.");
    v("gap", &T::gap, "Success: the two are at most this far apart, metres.", Bound::kPositive);
  }
};

// Visits the fields of tasks about a joint of the surroundings.
template <class T, class V>
void JointTaskFields(V&& v) {
  v("object", &T::object,
    "The object with the joint, named as in the scene. Unset: drawn from `objects`, and put on the "
    "support.");
  v("objects", &T::objects, "Kinds of equipment that the object is drawn from.");
  v("joint", &T::joint,
    "The joint, by its name in the object's model. Unset: each start draws one of the object's "
    "joints.");
}

struct OpenTaskConfig {
  std::string object = {};
  NameList objects = {};
  std::string joint = {};
  double opening = 0.5;
  Vec2 start_opening = {0, 0};

  static constexpr const char* kKind = "open";
  static constexpr const char* kTypeName = "OpenTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = OpenTaskConfig;
    JointTaskFields<T>(v);
    v("opening", &T::opening, "Success: the joint is open by this share of its range at least.",
      Bound::kFraction);
    v("start_opening", &T::start_opening, "Its opening at the start, smallest and largest.",
      Bound::kFraction);
  }
  void Validate(Problems& problems) const;
};

struct CloseTaskConfig {
  std::string object = {};
  NameList objects = {};
  std::string joint = {};
  double opening = 0.15;
  Vec2 start_opening = {0.4, 0.7};

  static constexpr const char* kKind = "close";
  static constexpr const char* kTypeName = "CloseTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = CloseTaskConfig;
    JointTaskFields<T>(v);
    v("opening", &T::opening, "Success: the joint is open by this share of its range at most.",
      Bound::kFraction);
    v("start_opening", &T::start_opening, "Its opening at the start, smallest and largest.",
      Bound::kFraction);
  }
  void Validate(Problems& problems) const;
};

struct PressTaskConfig {
  std::string object = {};
  NameList objects = {};
  std::string joint = {};
  double depth = 0.7;

  static constexpr const char* kKind = "press";
  static constexpr const char* kTypeName = "PressTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = PressTaskConfig;
    JointTaskFields<T>(v);
    v("depth", &T::depth, "Success: the button has been pressed by this share of its range.",
      Bound::kFraction);
  }
};

struct PushTaskConfig {
  NameList objects = {};
  Vec2 distance = {0.08, 0.14};

  static constexpr const char* kKind = "push";
  static constexpr const char* kTypeName = "PushTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = PushTaskConfig;
    v("objects", &T::objects,
      "Kinds or categories of the catalogue that the object is drawn from. Unset: a flat "
      "`block`.");
    v("distance", &T::distance,
      "Distance from the object to the middle of the region at the start, metres. The region is a "
      "marked circle with a radius of 0.04 m.",
      Bound::kNonNegative);
  }
  void Validate(Problems& problems) const;
};

}  // namespace robocell
