#include "robocell/scenes/hollows.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <Eigen/Geometry>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

constexpr int kGrid = 9;                                  // rays along each side of the opening
constexpr double kLeastDepth = 0.01, kLeastWidth = 0.03;  // metres
constexpr double kOutside = 0.01;  // distance of the rays' start from the body
constexpr int kLeastCells = 4;

// The collision geoms of one body, in the body's frame.
class OwnGeoms {
 public:
  OwnGeoms(const Scene& scene, int body) : m_(scene.model()), d_(scene.data()) {
    const Pose body_to_world =
        Pose::FromTranslationAndMatrix(d_->xpos + 3 * body, d_->xmat + 9 * body);
    for (int g = m_->body_geomadr[body]; g < m_->body_geomadr[body] + m_->body_geomnum[body]; ++g) {
      if (!IsCollisionGeom(m_, g) || m_->geom_type[g] == mjGEOM_PLANE) continue;
      geoms_.push_back(g);
      const Pose in_body =
          body_to_world.inverse() *
          Pose::FromTranslationAndMatrix(d_->geom_xpos + 3 * g, d_->geom_xmat + 9 * g);
      const mjtNum* middle = m_->geom_aabb + 6 * g;
      for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3d at(middle[0], middle[1], middle[2]);
        for (int axis = 0; axis < 3; ++axis)
          at[axis] += (corner >> axis & 1 ? 1 : -1) * middle[3 + axis];
        bounds_.extend(in_body * at);
      }
    }
    body_to_world_ = body_to_world;
  }

  bool empty() const { return geoms_.empty(); }
  const Eigen::AlignedBox3d& bounds() const { return bounds_; }
  // Returns the distance to the first of them; negative if there is none.
  double Ray(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
    const Eigen::Vector3d point = body_to_world_ * from;
    const Eigen::Vector3d ray = body_to_world_.rotation() * direction;
    double nearest = -1;
    for (const int g : geoms_) {
      const double hit = RayToGeom(m_, d_, g, point, ray, nullptr);
      if (hit >= 0 && (nearest < 0 || hit < nearest)) nearest = hit;
    }
    return nearest;
  }

 private:
  const mjModel* m_;
  const mjData* d_;
  std::vector<int> geoms_;
  Pose body_to_world_;
  Eigen::AlignedBox3d bounds_;
};

// Returns the hollow that is open along one axis.
std::optional<Hollow> OpenAlong(const OwnGeoms& geoms, int axis, double sign) {
  const Eigen::AlignedBox3d& box = geoms.bounds();
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Eigen::Vector3d size = box.sizes();
  const Eigen::Vector3d out = sign * Eigen::Vector3d::Unit(axis);
  const double rim = sign > 0 ? box.max()[axis] : box.min()[axis];
  Eigen::AlignedBox3d inside;
  int cells = 0;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      Eigen::Vector3d at;
      at[u] = box.min()[u] + size[u] * (i + 0.5) / kGrid;
      at[v] = box.min()[v] + size[v] * (j + 0.5) / kGrid;
      at[axis] = rim + sign * kOutside;
      const double depth = geoms.Ray(at, -out) - kOutside;
      if (depth < kLeastDepth) continue;  // a wall, or no end of the hollow
      // Half way down there must be a wall on all four sides.
      Eigen::Vector3d half = at;
      half[axis] = rim - sign * depth / 2;
      bool walled = true;
      for (const int side : {u, v}) {
        for (const double to : {-1.0, 1.0})
          walled &= geoms.Ray(half, to * Eigen::Vector3d::Unit(side)) >= 0;
      }
      if (!walled) continue;
      ++cells;
      Eigen::Vector3d bottom = at;
      bottom[axis] = rim - sign * depth;
      Eigen::Vector3d top = at;
      top[axis] = rim;
      const Eigen::Vector3d reach = size[u] / kGrid / 2 * Eigen::Vector3d::Unit(u) +
                                    size[v] / kGrid / 2 * Eigen::Vector3d::Unit(v);
      inside.extend(bottom - reach);
      inside.extend(top + reach);
    }
  }
  if (cells < kLeastCells || std::min(inside.sizes()[u], inside.sizes()[v]) < kLeastWidth)
    return std::nullopt;
  return Hollow{inside.center(), ToVec3(inside.sizes() / 2), out};
}

double Volume(const Hollow& hollow) {
  return hollow.half_extents[0] * hollow.half_extents[1] * hollow.half_extents[2];
}

}  // namespace

std::optional<Hollow> FindHollow(const Scene& scene, int body) {
  const OwnGeoms geoms(scene, body);
  if (geoms.empty() || geoms.bounds().sizes().maxCoeff() < kLeastWidth) return std::nullopt;
  if (auto upward = OpenAlong(geoms, 2, 1)) return upward;
  std::optional<Hollow> best;
  for (const int axis : {0, 1}) {
    for (const double sign : {-1.0, 1.0}) {
      const std::optional<Hollow> hollow = OpenAlong(geoms, axis, sign);
      if (hollow && (!best || Volume(*hollow) > Volume(*best))) best = hollow;
    }
  }
  return best;
}

std::vector<HollowOfBody> FindHollows(const Scene& scene, int root) {
  std::vector<HollowOfBody> found;
  for (int body = root; body < scene.model()->nbody; ++body) {
    if (!IsInSubtree(scene.model(), body, root)) continue;
    if (const auto hollow = FindHollow(scene, body)) found.push_back({body, *hollow});
  }
  return found;
}

}  // namespace robocell::internal
