#include "robocell/motion/geom_extent.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <Eigen/Geometry>

#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

// Returns half the extent of a shape around its own centre, `u` in the geom's frame.
double HalfExtent(int type, const double* s, const Eigen::Vector3d& u) {
  const Eigen::Vector3d a = u.cwiseAbs();
  switch (type) {
    case mjGEOM_SPHERE:
      return s[0];
    case mjGEOM_CAPSULE:
      return s[0] + s[1] * a.z();
    case mjGEOM_CYLINDER:
      return s[0] * std::hypot(u.x(), u.y()) + s[1] * a.z();
    case mjGEOM_ELLIPSOID:
      return std::hypot(s[0] * u.x(), s[1] * u.y(), s[2] * u.z());
    case mjGEOM_BOX:
      return s[0] * a.x() + s[1] * a.y() + s[2] * a.z();
    default:
      return std::numeric_limits<double>::infinity();
  }
}

Interval MeshExtent(const mjModel* m, int mesh, const Eigen::Vector3d& u) {
  Interval extent{std::numeric_limits<double>::infinity(),
                  -std::numeric_limits<double>::infinity()};
  const float* vertex = m->mesh_vert + 3 * m->mesh_vertadr[mesh];
  for (int i = 0; i < m->mesh_vertnum[mesh]; ++i, vertex += 3) {
    const double along = vertex[0] * u.x() + vertex[1] * u.y() + vertex[2] * u.z();
    extent.lower = std::min(extent.lower, along);
    extent.upper = std::max(extent.upper, along);
  }
  return extent;
}

Interval LocalExtent(const mjModel* m, int geom, const Eigen::Vector3d& u) {
  const int type = m->geom_type[geom];
  if (type == mjGEOM_MESH) return MeshExtent(m, m->geom_dataid[geom], u);
  if (type == mjGEOM_HFIELD || type == mjGEOM_SDF) {
    const double* box = m->geom_aabb + 6 * geom;
    const double centre = box[0] * u.x() + box[1] * u.y() + box[2] * u.z();
    const double half = HalfExtent(mjGEOM_BOX, box + 3, u);
    return {centre - half, centre + half};
  }
  const double half = HalfExtent(type, m->geom_size + 3 * geom, u);
  return {-half, half};
}

}  // namespace

Interval GeomExtent(const mjModel* m, const mjData* d, int geom, const Eigen::Vector3d& direction) {
  double u[3];
  mju_mulMatTVec3(u, d->geom_xmat + 9 * geom, direction.data());
  const double centre = mju_dot3(d->geom_xpos + 3 * geom, direction.data());
  const Interval local = LocalExtent(m, geom, Eigen::Vector3d(u[0], u[1], u[2]));
  return {centre + local.lower, centre + local.upper};
}

Interval BodyExtent(const mjModel* model, const mjData* data, int body,
                    const Eigen::Vector3d& direction) {
  Interval all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const int geom : CollisionGeomsOf(model, body)) {
    const Interval extent = GeomExtent(model, data, geom, direction);
    all.lower = std::min(all.lower, extent.lower);
    all.upper = std::max(all.upper, extent.upper);
  }
  return all;
}

bool IsCollisionGeom(const mjModel* m, int geom) {
  return m->geom_contype[geom] != 0 || m->geom_conaffinity[geom] != 0;
}

std::vector<int> CollisionGeomsOf(const mjModel* m, int body) {
  std::vector<int> geoms;
  for (int g = 0; g < m->ngeom; ++g) {
    if (IsCollisionGeom(m, g) && IsInSubtree(m, m->geom_bodyid[g], body)) geoms.push_back(g);
  }
  return geoms;
}

double RayToGeom(const mjModel* m, const mjData* d, int g, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& direction, Eigen::Vector3d* normal) {
  mjtNum* out = normal ? normal->data() : nullptr;
  switch (m->geom_type[g]) {
    case mjGEOM_MESH:
      return mj_rayMesh(m, d, g, from.data(), direction.data(), out);
    case mjGEOM_HFIELD:
      return mj_rayHfield(m, d, g, from.data(), direction.data(), out);
    case mjGEOM_SDF:  // only its plug-in knows the shape
      return -1;
    default:
      return mju_rayGeom(d->geom_xpos + 3 * g, d->geom_xmat + 9 * g, m->geom_size + 3 * g,
                         from.data(), direction.data(), m->geom_type[g], out);
  }
}

RayHit CastRay(const mjModel* m, const mjData* d, const std::vector<int>& geoms,
               const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  RayHit nearest{std::numeric_limits<double>::infinity(), Eigen::Vector3d::Zero()};
  for (const int g : geoms) {
    // Skips geoms whose bounding sphere the ray misses: the rays of one object usually miss most of
    // its parts.
    const Eigen::Vector3d to = Eigen::Vector3d(d->geom_xpos + 3 * g) - from;
    const bool bounded = m->geom_rbound[g] > 0;  // not a plane
    if (bounded && to.cross(direction).norm() > m->geom_rbound[g] + 1e-6) continue;
    Eigen::Vector3d normal;
    const double distance = RayToGeom(m, d, g, from, direction, &normal);
    if (distance >= 0 && distance < nearest.distance) nearest = {distance, normal};
  }
  return nearest;
}

double RadiusOf(const mjModel* m, int body) {
  double radius = 0;
  for (int b = 0; b < m->nbody; ++b) {
    if (!IsInSubtree(m, b, body)) continue;
    double from_root = 0;  // joints in between turn what hangs on them, and do not lengthen it
    for (int up = b; up != body; up = m->body_parentid[up])
      from_root += mju_norm3(m->body_pos + 3 * up);
    for (int i = 0; i < m->body_geomnum[b]; ++i) {
      const int g = m->body_geomadr[b] + i;
      radius = std::max(radius, from_root + mju_norm3(m->geom_pos + 3 * g) + m->geom_rbound[g]);
    }
  }
  return radius;
}

}  // namespace robocell::internal
