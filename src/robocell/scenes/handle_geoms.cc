#include "robocell/scenes/handle_geoms.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cctype>
#include <cstddef>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

bool IsHandleName(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name.find("handle") != std::string::npos || name.find("knob") != std::string::npos;
}

}  // namespace

std::string NameInObject(const Scene& scene, int body, const std::string& full_name) {
  const mjModel* m = scene.model();
  size_t prefix = 0;  // of the innermost object: one may be attached to another
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    const size_t size = object.name.size() + 1;
    if (size <= prefix || !full_name.starts_with(object.name + "_")) continue;
    const int root = FindId(m, mjOBJ_BODY, object.root_body);
    if (root > 0 && IsInSubtree(m, body, root)) prefix = size;
  }
  return full_name.substr(prefix);
}

bool IsHandleGeom(const Scene& scene, int geom) {
  const mjModel* m = scene.model();
  const std::string name = ElementName(m, mjOBJ_GEOM, geom);
  // Most names are settled without a search for the object.
  return IsHandleName(name) && IsHandleName(NameInObject(scene, m->geom_bodyid[geom], name));
}

}  // namespace robocell::internal
