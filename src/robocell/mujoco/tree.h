// Queries of a compiled model's body tree. Ids are not checked.
#pragma once

#include <mujoco/mjtype.h>

#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

// Returns true if a body is `root` or below it. Every body is below the world, body 0.
bool IsInSubtree(const mjModel* model, int body, int root);

// Returns the same for each body of the model.
std::vector<bool> SubtreeMask(const mjModel* model, int root);

// Returns the lowest body that is, or carries, both of them.
int CommonAncestor(const mjModel* model, int a, int b);

// Returns true if a joint is all that is between two bodies, or nothing: where the base stands on
// the world, the engine lets such neighbours touch.
bool AreNeighbours(const mjModel* model, int a, int b);

// Returns the body of a joint, degree of freedom, geom, site, camera or light, and a body itself;
// -1 for other kinds.
int BodyOf(const mjModel* model, mjtObj kind, int id);

}  // namespace robocell::internal
