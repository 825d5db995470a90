#include "robocell/task/pick_task.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell {
namespace {

std::vector<int> RobotRoots(const Scene& scene) {
  std::vector<int> roots;
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    roots.push_back(FindId(scene.model(), mjOBJ_BODY, robot.base_body));
  }
  return roots;
}

}  // namespace

Touching TouchingBody(const Scene& scene, const std::string& body) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  const int object = RequireId(m, mjOBJ_BODY, body, "scene '" + scene.name() + "'");
  const std::vector<int> robots = RobotRoots(scene);
  Touching touching;
  for (int c = 0; c < d->ncon; ++c) {
    if (d->contact[c].exclude != 0 || d->contact[c].geom[0] < 0 || d->contact[c].geom[1] < 0)
      continue;
    const int a = m->geom_bodyid[d->contact[c].geom[0]], b = m->geom_bodyid[d->contact[c].geom[1]];
    const bool a_inside = IsInSubtree(m, a, object), b_inside = IsInSubtree(m, b, object);
    if (a_inside == b_inside) continue;  // neither, or the object with itself
    const int partner = a_inside ? b : a;
    const bool is_robot = std::any_of(robots.begin(), robots.end(),
                                      [&](int root) { return IsInSubtree(m, partner, root); });
    (is_robot ? touching.robot : touching.other) = true;
  }
  return touching;
}

bool OnlyRobotsTouch(const Scene& scene, const std::string& body) {
  const Touching touching = TouchingBody(scene, body);
  return touching.robot && !touching.other;
}

PickTask::PickTask(std::string object, std::string kind, std::vector<std::string> all_objects,
                   double lift_height)
    : object_(std::move(object)),
      kind_(std::move(kind)),
      all_objects_(std::move(all_objects)),
      lift_height_(lift_height) {}

void PickTask::Begin(const Scene& scene) {
  body_ = scene.compiled()->object(object_).root_body;
  start_height_ = scene.body_pose(body_).translation().z();
}

double PickTask::Lift(const Scene& scene) const {
  return scene.body_pose(body_).translation().z() - start_height_;
}

double PickTask::Reward(const Scene& scene) { return std::max(0.0, Lift(scene)); }

bool PickTask::Success(const Scene& scene) {
  if (Lift(scene) < lift_height_) return false;
  return OnlyRobotsTouch(scene, body_);
}

}  // namespace robocell
