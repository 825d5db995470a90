#include "robocell/scenes/handle_names.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cctype>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {

bool IsHandleName(const std::string& name) {
  std::string lower = name;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower.find("handle") != std::string::npos || lower.find("knob") != std::string::npos;
}

bool IsHandleGeom(const Scene& scene, int geom) {
  const mjModel* m = scene.model();
  const std::string name = ElementName(m, mjOBJ_GEOM, geom);
  if (!IsHandleName(name)) return false;
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    if (!name.starts_with(object.name + "_")) continue;
    const int root = FindId(m, mjOBJ_BODY, object.root_body);
    if (root >= 0 && IsInSubtree(m, m->geom_bodyid[geom], root))
      return IsHandleName(name.substr(object.name.size() + 1));
  }
  return true;
}

}  // namespace robocell::internal
