// The fields of the built-in kinds of tasks that need skill with an object in the hand: insert, sort,
// wipe, pour (held_tasks.h).
#pragma once

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

struct InsertTaskConfig {
  NameList shapes = {};
  double clearance = 0.001;
  double depth = 0.8;

  static constexpr const char* kKind = "insert";
  static constexpr const char* kTypeName = "InsertTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = InsertTaskConfig;
    v("shapes", &T::shapes,
      "What is drawn: square and round are pegs with their holes, plug is a plug with two blades "
      "and its socket. Unset: all three.");
    v("clearance", &T::clearance,
      "Difference between the width of a hole and that of its peg, metres. A plug has 0.001.",
      Bound::kPositive);
    v("depth", &T::depth, "Success: the object is in the hole by this share of its depth at least.",
      Bound::kFraction);
  }
  void Validate(Problems& problems) const;
};

struct SortTaskConfig {
  int objects = 3;
  double edge = 0.04;

  static constexpr const char* kKind = "sort";
  static constexpr const char* kTypeName = "SortTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    v("objects", &SortTaskConfig::objects,
      "Number of cubes, 2 to 6, and of plates of the same colours.");
    v("edge", &SortTaskConfig::edge, "Length of the edges of the cubes, metres.", Bound::kPositive);
  }
  void Validate(Problems& problems) const;
};

struct WipeTaskConfig {
  double share = 0.8;
  Vec2 distance = {0.15, 0.2};

  static constexpr const char* kKind = "wipe";
  static constexpr const char* kTypeName = "WipeTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = WipeTaskConfig;
    v("share", &T::share,
      "Success: this share of the marked area has been wiped, in cells of 1 cm, with 0.5 to 30 N.",
      Bound::kFraction);
    v("distance", &T::distance,
      "Distance from the sponge to the middle of the area at the start, metres. The area is 0.16 x "
      "0.12 m.",
      Bound::kNonNegative);
  }
  void Validate(Problems& problems) const;
};

struct PourTaskConfig {
  NameList objects = {};
  NameList receivers = {};
  int grains = 20;
  double grain_radius = 0.005;
  double share = 0.8;

  static constexpr const char* kKind = "pour";
  static constexpr const char* kTypeName = "PourTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = PourTaskConfig;
    v("objects", &T::objects,
      "Kinds of vessels to pour from, of the catalogue or of equipment. Unset: open_bottle.");
    v("receivers", &T::receivers, "Kinds of vessels to pour into. Unset: receiver.");
    v("grains", &T::grains, "Number of grains in the vessel, 20 to 200.");
    v("grain_radius", &T::grain_radius, "Their radius, metres.", Bound::kPositive);
    v("share", &T::share, "Success: this share of the grains is in the other vessel.",
      Bound::kFraction);
  }
  void Validate(Problems& problems) const;
};

}  // namespace robocell
