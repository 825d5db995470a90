#include "robocell/scenes/visibility.h"

#include <mujoco/mujoco.h>

#include <utility>
#include <vector>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

constexpr int kDrawnGroups = 3;                  // 0, 1, 2: what renderers draw
constexpr double kFractions[] = {-0.8, 0, 0.8};  // shares of a bounding box's half extents
constexpr double kSameDepth = 1e-3;              // metres

bool IsDrawn(const mjModel* m, int geom) {
  return m->geom_group[geom] < kDrawnGroups && m->geom_rgba[4 * geom + 3] > 0;
}

class Rays {
 public:
  Rays(const Scene& scene, const std::vector<bool>& bodies, const CameraModel& camera)
      : m_(scene.model()), d_(scene.data()), bodies_(bodies), camera_(camera) {
    sight_.hidden_by.assign(static_cast<size_t>(m_->nbody), 0);
  }

  // Looks at a point in the bounding box of one of the body's geoms.
  void Look(const Eigen::Vector3d& point) {
    const Eigen::Vector3d eye = camera_.camera_in_world.translation();
    const Eigen::Vector3d displacement = point - eye;
    const double far = displacement.norm();
    if (far < kSameDepth) return;
    const Eigen::Vector3d direction = displacement / far;
    static constexpr mjtByte kGroups[mjNGROUP] = {1, 1, 1, 0, 0, 0};
    int geom = -1;
    const double hit = mj_ray(m_, d_, eye.data(), direction.data(), kGroups, 1, -1, &geom, nullptr);
    if (geom < 0) return;  // it passes the object by: its bounding box is larger than it is
    const int body = m_->geom_bodyid[geom];
    if (bodies_[body]) {
      const bool in_image = camera_.Contains(eye + hit * direction);
      ++(in_image ? seen_ : hidden_);
    } else if (hit < far - kSameDepth) {
      ++hidden_;
      ++sight_.hidden_by[body];
    }
  }
  SightOfBodies Sight() && {
    if (seen_ > 0) sight_.share = static_cast<double>(seen_) / static_cast<double>(seen_ + hidden_);
    return std::move(sight_);
  }

 private:
  const mjModel* m_;
  const mjData* d_;
  const std::vector<bool>& bodies_;
  const CameraModel& camera_;
  SightOfBodies sight_;
  int seen_ = 0, hidden_ = 0;
};

}  // namespace

SightOfBodies SightOf(const Scene& scene, const std::vector<bool>& bodies,
                      const CameraModel& camera) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  Rays rays(scene, bodies, camera);
  for (int g = 0; g < m->ngeom; ++g) {
    if (!IsDrawn(m, g) || !bodies[m->geom_bodyid[g]]) continue;
    const Pose geom = Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * g, d->geom_xmat + 9 * g);
    const mjtNum* middle = m->geom_aabb + 6 * g;
    const mjtNum* half = middle + 3;
    for (const double x : kFractions) {
      for (const double y : kFractions) {
        for (const double z : kFractions) {
          rays.Look(geom * Eigen::Vector3d(middle[0] + x * half[0], middle[1] + y * half[1],
                                           middle[2] + z * half[2]));
        }
      }
    }
  }
  return std::move(rays).Sight();
}

double VisibleShare(const Scene& scene, const std::string& body, const CameraModel& camera) {
  const mjModel* m = scene.model();
  const int root = RequireId(m, mjOBJ_BODY, body, "scene '" + scene.name() + "'");
  return SightOf(scene, SubtreeMask(m, root), camera).share;
}

}  // namespace robocell::internal
