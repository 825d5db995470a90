#include "robocell/motion/convex_shape.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

constexpr int kCylinderSides = 32;
constexpr int kHeightFieldBlocks = 24;  // along each side, at most
constexpr double kThinnest = 1e-6;      // m: half the thickness of flat bodies

// Directions that are about evenly spread: the corners, edges and faces of a cube, and points
// between them.
std::vector<Vector3d> Directions(int steps) {
  std::vector<Vector3d> directions;
  for (int x = -steps; x <= steps; ++x) {
    for (int y = -steps; y <= steps; ++y) {
      for (int z = -steps; z <= steps; ++z) {
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != steps) continue;
        const auto bend = [&](int k) { return std::tan(std::numbers::pi / 4 * k / steps); };
        directions.push_back(Vector3d(bend(x), bend(y), bend(z)).normalized());
      }
    }
  }
  return directions;
}

ConvexShape SweptBall(double radius, double half_length) {
  const Vector3d corner(radius, radius, radius + half_length);
  return {.kind = ConvexShape::Kind::kSweptBall,
          .radius = radius,
          .half_length = half_length,
          .box = Eigen::AlignedBox3d(-corner, corner)};
}

ConvexShape Box(const Vector3d& centre, const Vector3d& half) {
  ConvexShape shape;
  shape.box = Eigen::AlignedBox3d(centre - half, centre + half);
  for (int i = 0; i < 3; ++i) {
    const Vector3d axis = Vector3d::Unit(i);
    shape.planes.push_back({axis, shape.box.max()[i]});
    shape.planes.push_back({-axis, -shape.box.min()[i]});
  }
  return shape;
}

ConvexShape Cylinder(double radius, double half_length) {
  ConvexShape shape = Box(Vector3d::Zero(), {radius, radius, half_length});
  std::erase_if(shape.planes, [](const HalfSpace& p) { return p.normal.z() == 0; });
  for (int k = 0; k < kCylinderSides; ++k) {
    const double angle = 2 * std::numbers::pi * k / kCylinderSides;
    shape.planes.push_back({{std::cos(angle), std::sin(angle), 0}, radius});
  }
  return shape;
}

ConvexShape Ellipsoid(const Vector3d& size) {
  ConvexShape shape = Box(Vector3d::Zero(), size);
  for (const Vector3d& sphere_normal : Directions(4)) {
    // The tangent plane at the image of a point of the unit sphere.
    const Vector3d normal = sphere_normal.cwiseQuotient(size).normalized();
    shape.planes.push_back({normal, normal.cwiseProduct(size).norm()});
  }
  return shape;
}

ConvexShape MeshHull(const mjModel* m, int mesh, int most_planes) {
  using Vertices = Eigen::Map<const Eigen::Matrix3Xf>;
  const Eigen::Matrix3Xd vertices =
      Vertices(m->mesh_vert + 3 * m->mesh_vertadr[mesh], 3, m->mesh_vertnum[mesh]).cast<double>();
  const Vector3d low = vertices.rowwise().minCoeff(), high = vertices.rowwise().maxCoeff();
  ConvexShape shape = Box((low + high) / 2, (high - low) / 2);
  const int polygons = m->mesh_polynum[mesh], first = m->mesh_polyadr[mesh];
  const auto add = [&](const Vector3d& normal) {
    shape.planes.push_back({normal, (normal.transpose() * vertices).maxCoeff()});
  };
  if (polygons <= most_planes - 6) {
    for (int p = first; p < first + polygons; ++p) {
      const Eigen::Map<const Vector3d> normal(m->mesh_polynormal + 3 * p);
      if (normal.norm() > 0.5) add(normal.normalized());
    }
  } else {
    for (const Vector3d& normal : Directions(most_planes >= 104 ? 2 : 1)) add(normal);
  }
  return shape;
}

std::vector<ConvexShape> HeightField(const mjModel* m, int field) {
  const int rows = m->hfield_nrow[field], columns = m->hfield_ncol[field];
  const double* size = m->hfield_size + 4 * field;
  const float* height = m->hfield_data + m->hfield_adr[field];
  std::vector<ConvexShape> shapes;
  const auto edges = [](int points) {  // first points of blocks, and the last point
    std::vector<int> at;
    const int blocks = std::min(kHeightFieldBlocks, points - 1);
    for (int k = 0; k <= blocks; ++k) at.push_back(k * (points - 1) / blocks);
    return at;
  };
  const std::vector<int> ys = edges(rows), xs = edges(columns);
  for (size_t i = 0; i + 1 < ys.size(); ++i) {
    for (size_t j = 0; j + 1 < xs.size(); ++j) {
      float top = 0;
      for (int r = ys[i]; r <= ys[i + 1]; ++r) {
        for (int c = xs[j]; c <= xs[j + 1]; ++c) top = std::max(top, height[r * columns + c]);
      }
      const auto x = [&](int c) { return size[0] * (2.0 * c / (columns - 1) - 1); };
      const auto y = [&](int r) { return size[1] * (2.0 * r / (rows - 1) - 1); };
      const Vector3d low(x(xs[j]), y(ys[i]), -size[3]);
      const Vector3d high(x(xs[j + 1]), y(ys[i + 1]), size[2] * top);
      shapes.push_back(Box((low + high) / 2, (high - low) / 2));
    }
  }
  return shapes;
}

}  // namespace

std::vector<ConvexShape> ConvexShapesOf(const mjModel* m, int geom, int most_planes) {
  const double* size = m->geom_size + 3 * geom;
  switch (m->geom_type[geom]) {
    case mjGEOM_PLANE:
      return {{.kind = ConvexShape::Kind::kHalfSpace, .planes = {{Vector3d::UnitZ(), 0}}}};
    case mjGEOM_HFIELD:
      return HeightField(m, m->geom_dataid[geom]);
    case mjGEOM_SPHERE:
      return {SweptBall(size[0], 0)};
    case mjGEOM_CAPSULE:
      return {SweptBall(size[0], size[1])};
    case mjGEOM_CYLINDER:
      return {Cylinder(size[0], size[1])};
    case mjGEOM_ELLIPSOID:
      return {Ellipsoid(Vector3d(size).cwiseMax(kThinnest))};
    case mjGEOM_BOX:
      return {Box(Vector3d::Zero(), Vector3d(size))};
    case mjGEOM_MESH:
      return {MeshHull(m, m->geom_dataid[geom], most_planes)};
    default: {  // only a plug-in knows the shape
      const double* box = m->geom_aabb + 6 * geom;
      return {Box(Vector3d(box), Vector3d(box + 3))};
    }
  }
}

double Depth(const ConvexShape& shape, const Vector3d& point) {
  if (shape.kind == ConvexShape::Kind::kSweptBall) {
    const double along = std::clamp(point.z(), -shape.half_length, shape.half_length);
    return shape.radius - (point - Vector3d(0, 0, along)).norm();
  }
  double depth = std::numeric_limits<double>::infinity();
  for (const HalfSpace& plane : shape.planes)
    depth = std::min(depth, plane.offset - plane.normal.dot(point));
  return depth;
}

Vector3d Approach(const ConvexShape& shape, Vector3d point, int rounds) {
  if (shape.kind == ConvexShape::Kind::kSweptBall) {
    const Vector3d axis(0, 0, std::clamp(point.z(), -shape.half_length, shape.half_length));
    const double distance = (point - axis).norm();
    return distance <= shape.radius ? point : axis + (point - axis) * (shape.radius / distance);
  }
  // Projections on half-spaces that contain the body.
  for (int k = 0; k < rounds; ++k) {
    const HalfSpace* worst = nullptr;
    double most = 0;
    for (const HalfSpace& plane : shape.planes) {
      const double beyond = plane.normal.dot(point) - plane.offset;
      if (beyond > most) most = beyond, worst = &plane;
    }
    if (!worst) break;
    point -= most * worst->normal;
  }
  return point;
}

}  // namespace robocell::internal
