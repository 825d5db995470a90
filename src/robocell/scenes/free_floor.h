// The free floor of a scene: where a robot can stand.
#pragma once

#include <vector>

#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell::internal {

// Level rectangles of the floor over which nothing is up to kHeadroom, largest first and apart from
// each other, each at least kLeastSide long and wide. Floors are level planes and, as high as the
// lowest of these and of such faces, level upper faces of boxes of at least a square metre. An
// endless plane ends kMargin beyond everything else. Geoms are boxes around what they are, so that
// something may be free that is not listed. Robots and parked objects do not count; `ignored` are
// their bodies. Poses of the scene are up to date.
std::vector<FloorArea> FindFreeFloor(const Scene& scene, const std::vector<bool>& ignored);

inline constexpr double kHeadroom = 2, kLeastSide = 0.5, kMargin = 1.5;  // metres

}  // namespace robocell::internal
