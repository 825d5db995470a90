#include "robocell/env/base_frame.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robocell/mujoco/names.h"
#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {
namespace {

int RootBody(const Robot& robot) {
  for (const RobotRecord& record : robot.scene().compiled()->robots()) {
    if (record.name == robot.name())
      return FindId(robot.scene().model(), mjOBJ_BODY, record.root_body);
  }
  return -1;
}

// Returns how far one joint can move a point, m.
double TravelOf(const mjModel* m, const mjData* d, int joint, const Eigen::Vector3d& point) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  const mjtNum* range = m->jnt_range + 2 * joint;
  const Eigen::Vector3d lever = point - Eigen::Map<const Eigen::Vector3d>(d->xanchor + 3 * joint);
  switch (m->jnt_type[joint]) {
    case mjJNT_SLIDE: {
      const double now = d->qpos[m->jnt_qposadr[joint]];
      return m->jnt_limited[joint] ? std::max(std::abs(range[0] - now), std::abs(range[1] - now))
                                   : kAny;
    }
    case mjJNT_HINGE: {
      const Eigen::Map<const Eigen::Vector3d> axis(d->xaxis + 3 * joint);
      return 2 * axis.cross(lever).norm();
    }
    case mjJNT_BALL:
      return 2 * lever.norm();
    default:
      return kAny;
  }
}

}  // namespace

Pose BaseInSharedFrame(const Robot& robot) {
  return robot.scene().shared_base_frame_to_world().inverse() * robot.base_in_world();
}

std::optional<double> BaseTravel(const Robot& robot) {
  const mjModel* m = robot.scene().model();
  const mjData* d = robot.scene().data();
  const Eigen::Vector3d base = robot.base_in_world().translation();
  std::optional<double> travel;
  // Distances of several joints add up at most.
  for (int body = RootBody(robot); body > 0; body = m->body_parentid[body]) {
    for (int i = 0; i < m->body_jntnum[body]; ++i)
      travel = travel.value_or(0) + TravelOf(m, d, m->body_jntadr[body] + i, base);
    // A mocap base stands still unless it is teleported.
    if (m->body_mocapid[body] >= 0) travel = travel.value_or(0);
  }
  return travel;
}

}  // namespace robocell::internal
