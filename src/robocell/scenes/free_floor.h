// The free floor of a scene, on which a robot can stand.
#pragma once

#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>
#include <mujoco/mujoco.h>

#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell::internal {

// Returns the level rectangles of floors with kHeadroom above them, largest first and apart from
// each other, each at least kLeastSide long and wide. Floors of all levels count: level planes, and
// level upper faces of boxes of at least kLeastFloor along both sides. As high as furniture is
// above the floor under it (kLowestFurniture to kHighestFurniture), a face is a table and no floor,
// unless it is as large as a room (kLeastStage). An endless plane ends kMargin beyond everything
// else, and beyond `points`. Geoms are boxes around what they are, so that something may be free that is not listed.
// Bodies that are `ignored`, by number, do not count (MovedBodies). Poses of the scene are up to
// date.
std::vector<FloorArea> FindFreeFloor(const Scene& scene, const std::vector<bool>& ignored,
                                     std::span<const Eigen::Vector3d> points = {});

// Returns the corners of the box around a geom, in the world.
std::vector<Eigen::Vector3d> BoxCornersOf(const mjModel* m, const mjData* d, int g);

// Returns, by number, the bodies that are no surroundings: robots, parked objects, and the trees
// below the bodies `more`.
std::vector<bool> MovedBodies(const Scene& scene, std::span<const std::string> more = {});

inline constexpr double kHeadroom = 2, kLeastSide = 0.5, kMargin = 1.5;  // metres
inline constexpr double kLeastFloor = 1, kLeastStage = 2;                // metres
inline constexpr double kLowestFurniture = 0.15,
                        kHighestFurniture = 1.6;  // furniture above its floor, metres

}  // namespace robocell::internal
