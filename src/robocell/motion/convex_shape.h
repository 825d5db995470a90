// Convex bodies that contain the collision geoms of a model: what spheres are fitted to, and what
// spheres are tested against.
//
// A geom is one body: a ball swept along a segment (spheres, capsules; exact), a polytope (boxes
// and the hulls of meshes exactly; cylinders, ellipsoids and signed distance fields from outside)
// or a half-space (planes). Height fields are several boxes. All are in the geom's own frame, m.
//
//   for (const ConvexShape& shape : ConvexShapesOf(model, geom)) Depth(shape, point);
#pragma once

#include <vector>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

// The points x with normal . x <= offset; the normal has unit length.
struct HalfSpace {
  Eigen::Vector3d normal;
  double offset;
};

struct ConvexShape {
  enum class Kind { kSweptBall, kPolytope, kHalfSpace };

  Kind kind = Kind::kPolytope;
  // kSweptBall: all points within `radius` of the segment of this half length on the z axis.
  double radius = 0, half_length = 0;
  std::vector<HalfSpace> planes{};  // kPolytope; one for kHalfSpace
  Eigen::AlignedBox3d box{};        // contains the body; empty for kHalfSpace
};

// Returns bodies whose union contains the geom. `most_planes` bounds the planes of a polytope:
// with fewer it is larger, by a few hundredths of its size.
std::vector<ConvexShape> ConvexShapesOf(const mjModel* model, int geom, int most_planes = 1000);

// Returns how deep a point is inside the body, m. Negative outside, where the distance to the body
// is at least its absolute value.
double Depth(const ConvexShape& shape, const Eigen::Vector3d& point);

// Moves a point that is outside towards the body: no point of the body gets farther from it.
// Points inside stay. The result is in the body, up to a remainder that shrinks with each round.
Eigen::Vector3d Approach(const ConvexShape& shape, Eigen::Vector3d point, int rounds = 12);

}  // namespace robocell::internal
