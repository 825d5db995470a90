#include "robocell/task/held.h"

#include <mujoco/mujoco.h>

#include <optional>
#include <vector>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/sleeping.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/gripper_group.h"
#include "robocell/robot/robot.h"

namespace robocell::internal {
namespace {

std::vector<int> RobotRoots(const Scene& scene) {
  std::vector<int> roots;
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    roots.push_back(FindId(scene.model(), mjOBJ_BODY, robot.base_body));
  }
  return roots;
}

// Returns the root of the robot that a body belongs to (the outermost where robots carry robots),
// or -1.
int RobotOf(const mjModel* m, const std::vector<int>& roots, int body) {
  int robot = -1;
  for (const int root : roots) {
    if (IsInSubtree(m, body, root) && (robot < 0 || IsInSubtree(m, robot, root))) robot = root;
  }
  return robot;
}

struct Partners {
  int robot = -1;  // the root of a robot that touches it
  bool several_robots = false;
  bool other = false;
};

Partners PartnersOf(const Scene& scene, const std::vector<int>& roots, const std::string& body) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  const int object = RequireId(m, mjOBJ_BODY, body, "scene '" + scene.name() + "'");
  Partners partners;
  partners.other = Sleeps(m, d, object);  // on something, without a contact
  for (int c = 0; c < d->ncon; ++c) {
    if (d->contact[c].exclude != 0 || d->contact[c].geom[0] < 0 || d->contact[c].geom[1] < 0)
      continue;
    const int a = m->geom_bodyid[d->contact[c].geom[0]], b = m->geom_bodyid[d->contact[c].geom[1]];
    const bool a_inside = IsInSubtree(m, a, object), b_inside = IsInSubtree(m, b, object);
    if (a_inside == b_inside) continue;  // neither, or the object touches itself
    const int robot = RobotOf(m, roots, a_inside ? b : a);
    partners.other |= robot < 0;
    if (robot < 0) continue;
    partners.several_robots |= partners.robot >= 0 && robot != partners.robot;
    partners.robot = robot;
  }
  return partners;
}

// Returns true if a gripper of this robot grasps the object; unset for a robot without a gripper.
std::optional<bool> IsGrasped(const Scene& scene, const std::vector<int>& roots, int by,
                              const std::string& body) {
  std::optional<bool> grasped;
  for (const Robot& robot : RobotsOf(scene)) {
    const std::string& base = scene.compiled()->robot(robot.name()).base_body;
    if (RobotOf(scene.model(), roots, FindId(scene.model(), mjOBJ_BODY, base)) != by) continue;
    for (const std::string& name : robot.group_names()) {
      const auto* gripper = dynamic_cast<const GripperGroup*>(&robot.group(name));
      if (gripper) grasped = grasped.value_or(false) || gripper->is_grasping(body);
    }
  }
  return grasped;
}

}  // namespace

Touching TouchingBody(const Scene& scene, const std::string& body) {
  const Partners partners = PartnersOf(scene, RobotRoots(scene), body);
  return {partners.robot >= 0, partners.other};
}

bool OnlyRobotsTouch(const Scene& scene, const std::string& body) {
  const Touching touching = TouchingBody(scene, body);
  return touching.robot && !touching.other;
}

bool IsHeld(const Scene& scene, const std::string& body) {
  const std::vector<int> roots = RobotRoots(scene);
  const Partners partners = PartnersOf(scene, roots, body);
  if (partners.robot < 0 || partners.other) return false;
  return partners.several_robots || IsGrasped(scene, roots, partners.robot, body).value_or(true);
}

double ForceOnOthers(const Scene& scene, int body) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  const std::vector<int> roots = RobotRoots(scene);
  double force = 0;
  for (int c = 0; c < d->ncon; ++c) {
    const mjContact& contact = d->contact[c];
    if (contact.exclude != 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    const int a = m->geom_bodyid[contact.geom[0]], b = m->geom_bodyid[contact.geom[1]];
    const bool a_inside = IsInSubtree(m, a, body), b_inside = IsInSubtree(m, b, body);
    if (a_inside == b_inside || RobotOf(m, roots, a_inside ? b : a) >= 0) continue;
    mjtNum in_contact[6];
    mj_contactForce(m, d, c, in_contact);
    force += in_contact[0];
  }
  return force;
}

}  // namespace robocell::internal
