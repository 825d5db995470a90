#include "robocell/mujoco/tree.h"

#include <mujoco/mujoco.h>

#include <algorithm>

namespace robocell::internal {

// A parent's id is smaller than those of its children.
bool IsInSubtree(const mjModel* m, int body, int root) {
  while (body > root && body > 0) body = m->body_parentid[body];
  return body == root;
}

std::vector<bool> SubtreeMask(const mjModel* m, int root) {
  std::vector<bool> inside(static_cast<size_t>(m->nbody));
  for (int b = root; b < m->nbody; ++b) inside[b] = b == root || inside[m->body_parentid[b]];
  return inside;
}

int CommonAncestor(const mjModel* m, int a, int b) {
  while (a != b) (a > b ? a : b) = m->body_parentid[std::max(a, b)];
  return a;
}

bool AreNeighbours(const mjModel* model, int a, int b) {
  const int link_a = model->body_weldid[a], link_b = model->body_weldid[b];
  const auto above = [&](int link) { return model->body_weldid[model->body_parentid[link]]; };
  return link_a == link_b || above(link_a) == link_b || above(link_b) == link_a;
}

int BodyOf(const mjModel* m, mjtObj kind, int id) {
  switch (kind) {
    case mjOBJ_BODY:
    case mjOBJ_XBODY:
      return id;
    case mjOBJ_JOINT:
      return m->jnt_bodyid[id];
    case mjOBJ_DOF:
      return m->dof_bodyid[id];
    case mjOBJ_GEOM:
      return m->geom_bodyid[id];
    case mjOBJ_SITE:
      return m->site_bodyid[id];
    case mjOBJ_CAMERA:
      return m->cam_bodyid[id];
    case mjOBJ_LIGHT:
      return m->light_bodyid[id];
    default:
      return -1;
  }
}

}  // namespace robocell::internal
