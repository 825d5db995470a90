#include "robocell/mujoco/tree.h"

#include <mujoco/mujoco.h>

#include <algorithm>

namespace robocell {

// A parent's id is smaller than those of its children.
bool IsInSubtree(const mjModel* m, int body, int root) {
  while (body > root) body = m->body_parentid[body];
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

}  // namespace robocell
