// The meshes of a model's drawing: those of its assets, its planes and height fields, and round
// shapes, tessellated as finely as its `visual/quality` defines, like in OpenGL. Internal to
// render/.
#pragma once

#include <mujoco/mujoco.h>

#include "robocell/render/soft_mesh.h"

namespace robocell::internal {

// Shapes of unit size. Capsules are an open cylinder and two half spheres.
struct SoftShapes {
  SoftMesh sphere, upper_half, lower_half;  // the halves are centred at z = 1 and z = -1
  SoftMesh cylinder, open_cylinder;         // height from z = -1 to z = 1
  SoftMesh cone;                            // height from z = 0 to z = 1
  SoftMesh box, plane, triangle;

  SoftShapes() = default;
  SoftShapes(int slices, int stacks);
};

SoftMesh MeshOfModel(const mjModel* model, int mesh);
SoftMesh PlaneOfModel(const mjModel* model, int geom);
SoftMesh HeightFieldOfModel(const mjModel* model, int field);

}  // namespace robocell::internal
