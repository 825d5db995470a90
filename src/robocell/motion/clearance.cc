#include "robocell/motion/clearance.h"

#include <mujoco/mujoco.h>

#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {
namespace {

// Bounding spheres farther apart than the horizon need no exact distance. Planes have no sphere.
bool MayBeNear(const mjModel* m, const mjData* d, int a, int b, double horizon) {
  if (m->geom_rbound[a] == 0 || m->geom_rbound[b] == 0) return true;
  return mju_dist3(d->geom_xpos + 3 * a, d->geom_xpos + 3 * b) <
         m->geom_rbound[a] + m->geom_rbound[b] + horizon;
}

}  // namespace

FloorContact::FloorContact(const Robot& robot)
    : model_(robot.scene().model()),
      data_(robot.scene().data()),
      is_planar_(robot.config().base.kind == BaseKind::kPlanar),
      plane_(robot.base().pose().translation().z()) {
  if (is_planar_ && robot.has_arm())
    arm_ = model_->jnt_bodyid[RequireId(model_, mjOBJ_JOINT, robot.joint_names().front(),
                                        "robot '" + robot.name() + "'")];
}

bool FloorContact::StandsOnFloors(int robot_geom) const {
  const int body = model_->geom_bodyid[robot_geom];
  if (model_->body_mocapid[body] >= 0) return true;
  return is_planar_ && (arm_ < 0 || !IsInSubtree(model_, body, arm_));
}

bool FloorContact::IsFloor(int geom) const {
  if (model_->geom_type[geom] == mjGEOM_PLANE) return true;
  return is_planar_ && model_->body_weldid[model_->geom_bodyid[geom]] == 0 &&
         GeomExtent(model_, data_, geom, Eigen::Vector3d::UnitZ()).upper < plane_ + kMostFloorStep;
}

Clearance RobotClearance(const Scene& scene, const Robot& robot, double horizon) {
  scene.SyncPoses();
  const mjModel* m = scene.model();
  mjData* d = scene.data();
  std::vector<char> own(m->ngeom, 0);
  for (const int g : robot.geom_ids()) own[g] = 1;
  const FloorContact floors(robot);
  double nearest = horizon;
  int robot_geom = -1, other_geom = -1;
  for (const int a : robot.collision_geom_ids()) {
    const bool on_mocap = m->body_mocapid[m->geom_bodyid[a]] >= 0;
    if (!IsCollisionGeom(m, a) && !on_mocap) continue;
    const bool may_touch_floor = floors.StandsOnFloors(a);
    for (int b = 0; b < m->ngeom; ++b) {
      if (own[b] || !IsCollisionGeom(m, b) || !MayBeNear(m, d, a, b, horizon)) continue;
      if (may_touch_floor && floors.IsFloor(b)) continue;
      const double distance = Guarded("distance of a robot to its surroundings", d, [&] {
        return mj_geomDistance(m, d, a, b, nearest, nullptr);
      });
      if (distance >= nearest) continue;
      nearest = distance;
      robot_geom = a;
      other_geom = b;
    }
  }
  if (robot_geom < 0) return {.distance = nearest, .robot_geom = {}, .other_geom = {}};
  return {nearest, Describe(m, mjOBJ_GEOM, robot_geom), Describe(m, mjOBJ_GEOM, other_geom)};
}

}  // namespace robocell::internal
