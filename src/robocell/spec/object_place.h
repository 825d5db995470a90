// ObjectPlace: where an object starts in relation to another object of the same start, or to a body
// of the scene.
//
//   start:
//     places:
//       mug: {on_top_of: shelf}
//       spoon: {inside: drawer}
//       plate: {next_to: mug, gap: [0.01, 0.05]}
//
// scenes/related_places.h draws such places.
#pragma once

#include <array>
#include <string>
#include <utility>

#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

// Relations between two objects: one lies on the other, lies in a hollow of it, or is beside it
// at most kMostGap away.
enum class Relation { kOnTopOf, kInside, kNextTo };
template <>
struct EnumNames<Relation> {
  static constexpr std::array kNames = {std::pair{Relation::kOnTopOf, "on_top_of"},
                                        std::pair{Relation::kInside, "inside"},
                                        std::pair{Relation::kNextTo, "next_to"}};
};

inline constexpr double kMostGap = 0.1;  // metres between objects next to each other

struct ObjectPlace {
  std::string on_top_of = {};  // not `on`, which YAML 1.1 reads as true
  std::string inside = {};
  std::string next_to = {};
  Vec2 gap = {0.02, kMostGap};

  static constexpr const char* kTypeName = "ObjectPlace";
  template <class V>
  static void Fields(V&& v) {
    v("on_top_of", &ObjectPlace::on_top_of, "The object or body that it lies on.");
    v("inside", &ObjectPlace::inside,
      "The object or body that it lies in: a tray, a drawer, a shelf of a cabinet.");
    v("next_to", &ObjectPlace::next_to,
      "The object or body that it lies beside, on the same support.");
    v("gap", &ObjectPlace::gap,
      "Free distance to what it is next to, along the line between their middles, metres, smallest "
      "and largest.",
      Bound::kNonNegative);
  }
  void Validate(Problems& problems) const;

  // Returns the relation that is set, and its reference. A valid place sets exactly one.
  Relation relation() const;
  const std::string& reference() const;
};

}  // namespace robocell
