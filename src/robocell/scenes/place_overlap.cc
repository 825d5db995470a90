#include "robocell/scenes/place_overlap.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <Eigen/Core>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/scratch_robot.h"
#include "robocell/scenes/free_floor.h"

namespace robocell::internal {
namespace {

void WriteGeom(mjData* d, int geom, const Pose& pose) {
  Eigen::Map<Eigen::Vector3d>(d->geom_xpos + 3 * geom) = pose.translation();
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d->geom_xmat + 9 * geom) =
      pose.rotation();
}

}  // namespace

PlaceOverlap::PlaceOverlap(const Scene& scene, int body)
    : scene_(scene.inner()), data_(MakeData(scene.model())) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  mju_copy(data_->geom_xpos, d->geom_xpos, 3 * m->ngeom);
  mju_copy(data_->geom_xmat, d->geom_xmat, 9 * m->ngeom);
  const Pose world_in_body =
      Pose::FromTranslationAndMatrix(d->xpos + 3 * body, d->xmat + 9 * body).inverse();
  const std::vector<bool> moved = MovedBodies(scene);
  for (int g = 0; g < m->ngeom; ++g) {
    if (!IsCollisionGeom(m, g)) continue;
    if (IsInSubtree(m, m->geom_bodyid[g], body)) {
      const Pose geom = Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * g, d->geom_xmat + 9 * g);
      own_.emplace_back(g, world_in_body * geom);
    } else if (!moved[static_cast<size_t>(m->geom_bodyid[g])]) {
      others_.push_back(g);
    }
  }
}

bool PlaceOverlap::IsFree(const Pose& body_in_world, double gap) {
  const mjModel* m = scene_.model();
  mjData* d = data_.get();
  const double horizon = std::max(0.0, gap) + kMostDeep;
  for (const auto& each : own_) {
    const int own = each.first;
    WriteGeom(d, own, body_in_world * each.second);
    for (const int other : others_) {
      if (!MayCollide(m, own, other)) continue;
      const bool is_bounded = m->geom_rbound[other] > 0;  // not a plane
      if (is_bounded && mju_dist3(d->geom_xpos + 3 * own, d->geom_xpos + 3 * other) >
                            m->geom_rbound[own] + m->geom_rbound[other] + std::max(0.0, gap))
        continue;
      const double distance = Guarded("distance of an object at a place", d, [&] {
        return mj_geomDistance(m, d, own, other, horizon, nullptr);
      });
      if (distance < gap) return false;
    }
  }
  return true;
}

}  // namespace robocell::internal
