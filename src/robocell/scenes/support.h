// Support: the level surface of a scene for its objects.
//
//   const Support support = FindSupport(base);   // a SceneSpec
//   Pose on_top = support.frame_to_world * Pose(Eigen::Vector3d(x, y, 0));   // |x| < half_x ...
#pragma once

#include <span>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/level_area.h"
#include "robocell/math/pose.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/scene_spec.h"

namespace robocell {

// A rectangle: its centre, z up, and half extents along its x and y; the depth of its body. Metres.
struct Support {
  Pose frame_to_world;
  double half_x = 0, half_y = 0;
  double thickness = 0;
  LevelArea area() const { return {frame_to_world, half_x, half_y, thickness}; }
};

// Returns the support of a base scene, in this order:
// 1. the largest level upper face of a fixed box with 0.3 m of room above its middle, free objects
//    aside, 0.15 to 1.6 m high
// 2. such a face at any height
// 3. free level floor, at most 1 m wide
// Names of sites, geoms and bodies do not matter; a source of scenes may annotate other supports
// (scene_source.h). Parked objects offer no support. Throws NotFoundError without face and floor.
Support FindSupport(const SceneSpec& base);

// The free parts of floors (free_floor.h), largest first, on which objects may stand where no face
// has room for them. The trees below the bodies `moved` do not count, and endless floors extend at
// least to `points`.
std::vector<Support> FindFloors(const Scene& scene, std::span<const std::string> moved = {},
                                std::span<const Eigen::Vector3d> points = {});

struct SupportFace;
// Returns all level upper faces of fixed boxes with room above: FindSupport's first, then by size.
std::vector<SupportFace> FindSupportFaces(const Scene& scene);

}  // namespace robocell
