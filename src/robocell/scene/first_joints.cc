// Contacts across the first joints of a robot.
//
// The engine lets a body pass through its parent, but not where the parent is fixed to the world:
// there the first link of an arm rubs on the base that it overlaps in its model (by 12 mm in the
// Gen3 of the Menagerie, whose first joint hardly turns then). For robots these contacts are
// excluded there too, so that a robot moves alike on every kind of base and with and without a
// configuration. Other parts that are fixed to the base still touch: they may be intended
// obstacles.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robocell/scene/robot_parts.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

bool HasJoint(mjsBody* body) { return !BodyElements(body, mjOBJ_JOINT).empty(); }

bool Collides(mjsBody* body) {
  const std::vector<mjsElement*> geoms = BodyElements(body, mjOBJ_GEOM);
  return std::any_of(geoms.begin(), geoms.end(), [](mjsElement* element) {
    const mjsGeom* geom = mjs_asGeom(element);
    return geom->contype != 0 || geom->conaffinity != 0;
  });
}

std::pair<std::string, std::string> Sorted(std::string a, std::string b) {
  if (b < a) std::swap(a, b);
  return {std::move(a), std::move(b)};
}

class Exclusions {
 public:
  explicit Exclusions(mjSpec* spec) : spec_(spec) {
    for (mjsElement* element : SpecElements(spec, mjOBJ_EXCLUDE)) {
      const mjsExclude* exclude = mjs_asExclude(element);
      known_.insert(Sorted(mjs_getString(exclude->bodyname1), mjs_getString(exclude->bodyname2)));
    }
  }

  // Adds the exclusion unless it exists.
  void Add(mjsBody* a, mjsBody* b) {
    const auto pair = Sorted(SpecName(a->element), SpecName(b->element));
    if (!known_.insert(pair).second) return;
    mjsExclude* exclude = mjs_addExclude(spec_);
    mjs_setString(exclude->bodyname1, pair.first.c_str());
    mjs_setString(exclude->bodyname2, pair.second.c_str());
  }

 private:
  mjSpec* spec_;
  std::set<std::pair<std::string, std::string>> known_;
};

// Requires a fixed `body`.
void ExcludeChildren(mjsBody* body, Exclusions* exclusions) {
  for (mjsElement* element : BodyElements(body, mjOBJ_BODY)) {
    mjsBody* child = mjs_asBody(element);
    if (!HasJoint(child)) {
      ExcludeChildren(child, exclusions);
    } else if (Collides(body) && Collides(child)) {
      exclusions->Add(body, child);
    }
  }
}

}  // namespace

void ExcludeFirstJoints(mjsBody* top, const SimOptions& options, mjSpec* spec) {
  const auto& off = options.disable;
  const bool wanted = std::find(off.begin(), off.end(), "filterparent") != off.end();
  if (wanted || HasJoint(top)) return;
  Exclusions exclusions(spec);
  ExcludeChildren(top, &exclusions);
}

}  // namespace robocell::internal
