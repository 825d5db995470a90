#include "robocell/spec/object_place.h"

#include "robocell/spec/validate.h"

namespace robocell {

void ObjectPlace::Validate(Problems& problems) const {
  const int relations = !on_top_of.empty() + !inside.empty() + !next_to.empty();
  if (relations == 0) {
    problems.Add(
        "where? Set one of on_top_of, inside and next_to to the name of an object or body");
  } else if (relations > 1) {
    problems.Add("only one of on_top_of, inside and next_to can be set");
  }
  ValidateRange(gap, "gap", problems);
}

Relation ObjectPlace::relation() const {
  if (!on_top_of.empty()) return Relation::kOnTopOf;
  return inside.empty() ? Relation::kNextTo : Relation::kInside;
}

const std::string& ObjectPlace::reference() const {
  switch (relation()) {
    case Relation::kOnTopOf:
      return on_top_of;
    case Relation::kInside:
      return inside;
    case Relation::kNextTo:
      break;
  }
  return next_to;
}

}  // namespace robocell
