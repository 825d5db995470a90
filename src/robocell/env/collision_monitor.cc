#include "robocell/env/collision_monitor.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/gripper_group.h"

namespace robocell::internal {
namespace {

void AddPair(std::pair<int, int> bodies, CollisionMonitor::Memory& to) {
  if (std::find(to.begin(), to.end(), bodies) == to.end()) to.push_back(bodies);
}

}  // namespace

CollisionMonitor::CollisionMonitor(std::vector<Watched> watched)
    : watched_(std::move(watched)), scene_(watched_.front().robot.scene()) {
  Bind();
}

void CollisionMonitor::MarkHand(const MoveGroup& gripper, bool counts) {
  const auto* fingers = dynamic_cast<const ActuatedGripper*>(&gripper);
  if (!fingers) return;
  const mjModel* m = scene_.model();
  const std::vector<bool> of_hand = SubtreeMask(m, fingers->hand_body());
  for (int g = 0; g < m->ngeom; ++g) {
    if (!of_hand[m->geom_bodyid[g]]) continue;
    of_gripper_[g] = true;
    if (!counts) owner_[g] = -1;
  }
}

void CollisionMonitor::MarkGeoms(const Watched& watched, int index) {
  for (const int body : watched.robot.body_ids()) body_owner_[body] = index;
  for (const int geom : watched.robot.collision_geom_ids()) owner_[geom] = index;
  const bool names_geoms = !watched.robot.config().collision_geoms.empty();
  if (watched.robot.has_gripper()) MarkHand(watched.robot.gripper(), names_geoms);
  for (const Robot& gripper : watched.grippers) {
    for (const int body : gripper.body_ids()) body_owner_[body] = index;
    const bool counts = !gripper.config().collision_geoms.empty();
    for (const int geom : gripper.geom_ids()) {
      owner_[geom] = -1;
      of_gripper_[geom] = true;
    }
    if (counts) {
      for (const int geom : gripper.collision_geom_ids()) owner_[geom] = index;
    }
    Ignore(gripper);
  }
  Ignore(watched.robot);
}

// Unknown names are errors only at first: the objects may be removed from the scene later.
void CollisionMonitor::Ignore(const Robot& robot) {
  const mjModel* m = scene_.model();
  for (const std::string& name : robot.config().ignored_collision_geoms) {
    const int ignored = bound_ ? FindId(m, mjOBJ_GEOM, name)
                               : RequireId(m, mjOBJ_GEOM, name,
                                           "robot '" + robot.name() + "': ignored_collision_geoms");
    if (ignored < 0) continue;
    for (const int geom : robot.collision_geom_ids()) harmless_.insert({geom, ignored});
  }
}

void CollisionMonitor::Bind() {
  if (generation_ == scene_.generation()) return;
  owner_.assign(scene_.model()->ngeom, -1);
  body_owner_.assign(scene_.model()->nbody, -1);
  of_gripper_.assign(scene_.model()->ngeom, false);
  harmless_.clear();
  for (size_t i = 0; i < watched_.size(); ++i) MarkGeoms(watched_[i], static_cast<int>(i));
  generation_ = scene_.generation();
  bound_ = true;
}

void CollisionMonitor::Begin() {
  if (generation_ != scene_.generation()) Forget();  // the ids changed
  Bind();
  if (!looked_) Look();
  found_ = touching_;
}

void CollisionMonitor::Recall(const Memory& memory) {
  Bind();
  touching_ = memory;
  looked_ = true;
}

void CollisionMonitor::Look() {
  looked_ = true;
  touching_.clear();
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  for (int c = 0; c < d->ncon; ++c) {
    const mjContact& contact = d->contact[c];
    const int a = contact.geom[0], b = contact.geom[1];
    if (contact.exclude != 0 || a < 0 || b < 0 || (owner_[a] < 0 && owner_[b] < 0)) continue;
    std::pair<int, int> bodies(m->geom_bodyid[a], m->geom_bodyid[b]);
    const bool same_robot = body_owner_[bodies.first] == body_owner_[bodies.second];
    if (same_robot && AreNeighbours(m, bodies.first, bodies.second)) continue;
    if (same_robot && of_gripper_[a] && of_gripper_[b]) continue;
    if (harmless_.contains({a, b}) || harmless_.contains({b, a})) continue;
    if (owner_[a] < 0) std::swap(bodies.first, bodies.second);
    AddPair(bodies, touching_);
  }
}

bool CollisionMonitor::FindNew() {
  Look();
  const size_t before = found_.size();
  for (const auto& bodies : touching_) AddPair(bodies, found_);
  return found_.size() > before;
}

Collision CollisionMonitor::MakeCollision(std::pair<int, int> bodies) const {
  const mjModel* m = scene_.model();
  const auto robot = [&](int body) {
    const int index = body_owner_[body];
    return index < 0 ? "" : watched_[index].robot.name();
  };
  return {robot(bodies.first), ElementName(m, mjOBJ_BODY, bodies.first), robot(bodies.second),
          ElementName(m, mjOBJ_BODY, bodies.second)};
}

std::vector<Collision> CollisionMonitor::found() const {
  std::vector<Collision> out;
  for (const auto& bodies : found_) out.push_back(MakeCollision(bodies));
  return out;
}

}  // namespace robocell::internal
