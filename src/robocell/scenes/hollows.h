// Hollows of bodies: the space in a tray, a drawer or a cabinet.
#pragma once

#include <optional>
#include <vector>

#include "robocell/scene/scene.h"
#include "robocell/spec/types.h"

namespace robocell::internal {

// A box in a body's frame, and its opening along one of the frame's axes.
struct Hollow {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Vec3 half_extents = {};
  Eigen::Vector3d opening = Eigen::Vector3d::UnitZ();
};

// Returns the hollow of a body's own collision geoms: open towards +z, else towards the side (+-x
// or +-y) with the most space; at least 1 cm deep and 3 cm wide, with the body itself on all other
// sides. Unset for a body without one. Poses of the scene must be up to date.
std::optional<Hollow> FindHollow(const Scene& scene, int body);

struct HollowOfBody {
  int body;
  Hollow hollow;
};
// Returns those of a body and its subtree.
std::vector<HollowOfBody> FindHollows(const Scene& scene, int root);

}  // namespace robocell::internal
