// Covers of spheres that were made before: robots and objects come back in scene after scene.
#pragma once

#include <memory>

#include "robocell/motion/sphere_cover.h"

namespace robocell::internal {

// Returns the cover of a shape with InflationFor(shape), from memory if it was made before in this
// process. Any thread.
std::shared_ptr<const SphereCover> CachedCover(const ConvexShape& shape);

}  // namespace robocell::internal
