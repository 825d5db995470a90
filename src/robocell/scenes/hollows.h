// Hollows of bodies: where something can be put into a tray, a drawer or a cabinet.
#pragma once

#include <optional>
#include <vector>

#include "robocell/scene/scene.h"
#include "robocell/spec/types.h"

namespace robocell::internal {

// A box in a body's frame, and the way out of it along one of the frame's axes.
struct Hollow {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Vec3 half_extents = {};
  Eigen::Vector3d opening = Eigen::Vector3d::UnitZ();
};

// The hollow of a body's own collision geoms: open towards +z, else towards the side, +-x or +-y,
// with the most room; at least 1 cm deep and 3 cm wide, with the body itself on all other sides.
// Unset for a body without one. Poses of the scene are up to date.
std::optional<Hollow> FindHollow(const Scene& scene, int body);

struct HollowOfBody {
  int body;
  Hollow hollow;
};
// Those of a body and of what hangs on it.
std::vector<HollowOfBody> FindHollows(const Scene& scene, int root);

}  // namespace robocell::internal
