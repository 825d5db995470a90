// The extent of geoms along a direction: exact for primitives and meshes, a bounding box for the
// rest.
#pragma once

#include <vector>
#include <Eigen/Core>

#include "robocell/mujoco/forward.h"
#include "robocell/robot/move_group.h"

namespace robocell::internal {

// Returns the smallest and largest coordinate of a geom along a unit vector of the world, metres;
// infinite for planes. The geom's pose in `data` must be up to date.
Interval GeomExtent(const mjModel* model, const mjData* data, int geom,
                    const Eigen::Vector3d& direction);

// Returns the same for all collision geoms of a body's subtree; inverted, infinite bounds without any.
Interval BodyExtent(const mjModel* model, const mjData* data, int body,
                    const Eigen::Vector3d& direction);

// Returns true if a geom takes part in collisions.
bool IsCollisionGeom(const mjModel* model, int geom);
// Returns the collision geoms of a body's subtree.
std::vector<int> CollisionGeomsOf(const mjModel* model, int body);

// Returns the distance in metres from the body's origin to the farthest point of its geoms, or an
// upper bound of it.
double RadiusOf(const mjModel* model, int body);

// Returns the distance along the unit vector `direction` to a geom of any kind, metres; negative if
// the ray misses it. `normal` may be null. Rays miss signed distance fields.
double RayToGeom(const mjModel* model, const mjData* data, int geom, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& direction, Eigen::Vector3d* normal);

// The distance along the unit vector `direction` to the first of these geoms, metres, and the
// surface's normal there; infinite if there is none.
struct RayHit {
  double distance;
  Eigen::Vector3d normal;
};
RayHit CastRay(const mjModel* model, const mjData* data, const std::vector<int>& geoms,
               const Eigen::Vector3d& from, const Eigen::Vector3d& direction);

}  // namespace robocell::internal
