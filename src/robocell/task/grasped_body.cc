#include "robocell/task/grasped_body.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {

GraspedBody FindGraspedBody(const Scene& scene, const std::string& name) {
  const mjModel* m = scene.model();
  GraspedBody found{.name = name};
  for (const ObjectRecord& object : scene.compiled()->objects())
    if (object.name == name) found.name = object.root_body;
  found.body = FindId(m, mjOBJ_BODY, found.name);
  if (found.body < 0) {
    std::vector<std::string> names = scene.object_names();
    for (const std::string& body : ElementNames(m, mjOBJ_BODY))
      if (!body.empty() && std::ranges::find(names, body) == names.end()) names.push_back(body);
    throw NotFoundError(NoSuchName("scene '" + scene.name() + "'", "object or body", name, names));
  }
  int innermost = 0;
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    const int top = FindId(m, mjOBJ_BODY, object.root_body);
    if (top <= innermost || !IsInSubtree(m, found.body, top)) continue;
    innermost = top;  // one object may be attached to another: children come later
    found.object = object.name;
  }
  std::vector<char> fixed(static_cast<size_t>(m->nbody), 0);
  fixed[static_cast<size_t>(found.body)] = 1;
  for (int b = found.body + 1; b < m->nbody; ++b)  // parents come first
    fixed[static_cast<size_t>(b)] =
        fixed[static_cast<size_t>(m->body_parentid[b])] && m->body_jntnum[b] == 0 && b > found.body;
  const int root = m->body_rootid[found.body];
  for (int g = 0; g < m->ngeom; ++g) {
    if (!IsCollisionGeom(m, g)) continue;
    const int body = m->geom_bodyid[g];
    if (fixed[static_cast<size_t>(body)]) {
      found.geoms.push_back(g);
    } else if (root > 0 && m->body_rootid[body] == root) {
      found.other_geoms.push_back(g);
    }
  }
  return found;
}

}  // namespace robocell::internal
