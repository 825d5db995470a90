// Questions about a compiled model's body tree. Ids are not checked.
#pragma once

#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell {

// Whether a body is `root` or hangs on it. Everything hangs on the world, body 0.
bool IsInSubtree(const mjModel* model, int body, int root);

// Per body of the model: the same.
std::vector<bool> SubtreeMask(const mjModel* model, int root);

// The lowest body that both are or hang on.
int CommonAncestor(const mjModel* model, int a, int b);

}  // namespace robocell
