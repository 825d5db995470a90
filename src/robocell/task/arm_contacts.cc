#include "robocell/task/arm_contacts.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/sleeping.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/acting_arms.h"

namespace robocell::internal {

int ArmContacts::Seen::touching() const { return static_cast<int>(std::ranges::count(touches, 1)); }

int ArmContacts::Seen::grasping() const { return static_cast<int>(std::ranges::count(grasps, 1)); }

int ArmContacts::Seen::only_holder() const {
  if (other || touching() != 1 || grasping() != 1) return -1;
  const auto arm = std::ranges::find(grasps, 1);
  return touches[static_cast<size_t>(arm - grasps.begin())] != 0
             ? static_cast<int>(arm - grasps.begin())
             : -1;
}

ArmContacts::ArmContacts(const Scene& scene, const std::string& body)
    : scene_(scene.inner()), body_(scene_, body) {
  for (const std::string& name : ActingArms(scene_)) {
    Robot robot = Robot::Of(scene_, name);
    if (!robot.has_gripper()) continue;
    arms_.push_back(name);
    robots_.push_back(std::move(robot));
  }
}

void ArmContacts::FindRoots() const {
  if (generation_ == scene_.generation() && !roots_.empty()) return;
  const mjModel* m = scene_.model();
  roots_.clear();
  for (const Robot& robot : robots_) {
    const int joint = FindId(m, mjOBJ_JOINT, robot.joint_names().front());
    roots_.push_back(joint < 0 ? -1 : m->jnt_bodyid[joint]);
  }
  generation_ = scene_.generation();
}

ArmContacts::Seen ArmContacts::Look() const {
  FindRoots();
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  Seen seen{.touches = std::vector<char>(arms_.size(), 0),
            .grasps = std::vector<char>(arms_.size(), 0)};
  seen.other = Sleeps(m, d, body_.id());
  for (int c = 0; c < d->ncon; ++c) {
    const mjContact& contact = d->contact[c];
    if (contact.exclude != 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    const int a = m->geom_bodyid[contact.geom[0]], b = m->geom_bodyid[contact.geom[1]];
    const bool a_inside = IsInSubtree(m, a, body_.id()), b_inside = IsInSubtree(m, b, body_.id());
    if (a_inside == b_inside) continue;
    const int partner = a_inside ? b : a;
    const auto root = std::ranges::find_if(
        roots_, [&](int arm) { return arm >= 0 && IsInSubtree(m, partner, arm); });
    if (root == roots_.end())
      seen.other = true;
    else
      seen.touches[static_cast<size_t>(root - roots_.begin())] = 1;
  }
  for (size_t i = 0; i < robots_.size(); ++i)
    seen.grasps[i] = robots_[i].gripper().is_grasping(body_.name()) ? 1 : 0;
  return seen;
}

}  // namespace robocell::internal
