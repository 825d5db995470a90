#include "robocell/motion/planning_scene.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/kinematics/chain.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/scratch_robot.h"

namespace robocell {

std::string ObstacleCounts::Text(const mjModel* model) const {
  const auto most =
      std::ranges::max_element(counts_, {}, &std::pair<const std::array<int, 2>, int>::second);
  if (most == counts_.end()) return "";
  const auto name = [&](int body) { return Describe(model, mjOBJ_BODY, body); };
  return fmt::format(" (most often {} with {})", name(most->first[0]), name(most->first[1]));
}

struct PlanningScene::State {
  State(const Robot& robot, std::shared_ptr<const GripperShape> g)
      : scratch(robot, kMostClearance + 0.005, "begin planning again"), shape(std::move(g)) {}

  void Place(const JointVector& q, double gap);
  void PlaceTarget(const Pose& in_world);
  void FindContents();

  internal::ScratchRobot scratch;
  std::shared_ptr<const GripperShape> shape;
  int target = -1;
  std::vector<char> is_target;  // per geom
  std::vector<char> is_inside;  // per geom: of a free body that lies in the target
  std::vector<int> fingers;     // addresses in qpos
  std::vector<double> finger_values;
  std::optional<Pose> target_in_tcp;  // set while it is held
  int checks = 0;
  std::array<int, 2> obstacle = {};
};

PlanningScene::PlanningScene(const Scene& scene, const Robot& robot, const std::string& target_body,
                             std::shared_ptr<const GripperShape> shape)
    : state_(std::make_unique<State>(robot, std::move(shape))) {
  State& s = *state_;
  const mjModel* m = s.scratch.model();
  s.target = RequireId(m, mjOBJ_BODY, target_body, "scene '" + scene.name() + "'");
  s.is_target.assign(m->ngeom, 0);
  for (int g = 0; g < m->ngeom; ++g)
    s.is_target[g] = internal::IsInSubtree(m, m->geom_bodyid[g], s.target);
  for (const std::string& name : s.shape->joint_names()) {
    const int joint =
        RequireId(m, mjOBJ_JOINT, robot.prefix() + name, "robot '" + robot.name() + "'");
    s.fingers.push_back(m->jnt_qposadr[joint]);
  }
  s.finger_values.resize(s.fingers.size());
  s.FindContents();
}

PlanningScene::~PlanningScene() = default;

void PlanningScene::State::Place(const JointVector& q, double gap) {
  scratch.SetArm(q);
  shape->JointsAt(gap, finger_values);
  for (size_t i = 0; i < fingers.size(); ++i) scratch.qpos()[fingers[i]] = finger_values[i];
  if (!target_in_tcp) return;
  const Robot& robot = scratch.robot();
  PlaceTarget(robot.base_in_world() * robot.chain().Fk(q) * *target_in_tcp);
}

void PlanningScene::State::PlaceTarget(const Pose& in_world) {
  const mjModel* m = scratch.model();
  const int joint = m->body_jntadr[target];
  if (joint < 0 || m->jnt_type[joint] != mjJNT_FREE) {
    throw ArgumentError(fmt::format("{} has no free joint, so that it cannot be carried",
                                    Describe(m, mjOBJ_BODY, target)));
  }
  mjtNum* at = scratch.qpos().data() + m->jnt_qposadr[joint];
  in_world.ToWxyz(at, at + 3);
}

// What lies in a vessel moves with it. That is each free body whose geoms are all within the box around
// the target's geoms, in its frame, over a floor of the target and between its walls: an object under a
// handle, or between legs, stays an obstacle.
void PlanningScene::State::FindContents() {
  const mjModel* m = scratch.model();
  const mjData* d = scratch.data();
  is_inside.assign(m->ngeom, 0);
  const Pose target_in_world =
      Pose::FromTranslationAndMatrix(d->xpos + 3 * target, d->xmat + 9 * target);
  Interval box[3];
  for (int axis = 0; axis < 3; ++axis)
    box[axis] = internal::BodyExtent(m, d, target, target_in_world.rotation().col(axis));
  std::vector<char> is_out(m->nbody, 0);
  for (int g = 0; g < m->ngeom; ++g) {
    const int root = m->body_rootid[m->geom_bodyid[g]];
    const Eigen::Vector3d at(d->geom_xpos + 3 * g);
    for (int axis = 0; axis < 3; ++axis) {
      const double along = at.dot(target_in_world.rotation().col(axis));
      if (along < box[axis].lower + m->geom_rbound[g] ||
          along > box[axis].upper - m->geom_rbound[g])
        is_out[root] = 1;
    }
  }
  const std::vector<int> own = internal::CollisionGeomsOf(m, target);
  const auto is_enclosed = [&](const Eigen::Vector3d& at) {
    int walls = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d direction = target_in_world.rotation().col(axis);
      for (const double sign : {-1.0, 1.0}) {
        const bool hits =
            std::isfinite(internal::CastRay(m, d, own, at, sign * direction).distance);
        if (!hits && axis == 2 && sign < 0) return false;  // no floor
        walls += hits;
      }
    }
    return walls >= 5;  // one side is open
  };
  for (int g = 0; g < m->ngeom; ++g) {
    const int root = m->body_rootid[m->geom_bodyid[g]];
    if (is_out[root] || is_target[g] || !internal::IsCollisionGeom(m, g)) continue;
    if (!is_enclosed(Eigen::Vector3d(d->geom_xpos + 3 * g))) is_out[root] = 1;
  }
  for (int g = 0; g < m->ngeom; ++g) {
    const int root = m->body_rootid[m->geom_bodyid[g]];
    const int joint = m->body_jntadr[root];
    const bool is_free = m->body_jntnum[root] == 1 && m->jnt_type[joint] == mjJNT_FREE;
    is_inside[g] = is_free && !is_out[root] && !is_target[g];
  }
}

void PlanningScene::Update() {
  state_->target_in_tcp.reset();
  state_->scratch.Update();
  state_->FindContents();
}

void PlanningScene::HoldTarget(const Pose& target_in_tcp) {
  state_->target_in_tcp = target_in_tcp;
  state_->scratch.Hold(state_->target);
}

void PlanningScene::PutTarget(const Pose& target_in_world) {
  state_->target_in_tcp.reset();
  state_->scratch.Hold(-1);
  state_->PlaceTarget(target_in_world);
}

bool PlanningScene::IsFree(const JointVector& q, const FreedomDemand& demand) {
  State& s = *state_;
  ++s.checks;
  s.Place(q, demand.gap);
  s.obstacle = {};
  if (!s.scratch.FindTouches()) return false;  // missing contacts may be collisions
  for (const internal::ScratchRobot::Touch& touch : s.scratch.touches()) {
    if (s.target_in_tcp && (s.is_inside[touch.own_geom] || s.is_inside[touch.other_geom])) continue;
    if (!touch.itself) {
      const bool wanted = s.is_target[touch.own_geom] || s.is_target[touch.other_geom];
      if (touch.distance >= demand.clearance || (demand.touch_target && wanted)) continue;
    }
    const mjModel* m = s.scratch.model();
    s.obstacle = {m->geom_bodyid[touch.own_geom], m->geom_bodyid[touch.other_geom]};
    return false;
  }
  return true;
}

std::array<int, 2> PlanningScene::obstacle() const { return state_->obstacle; }
int PlanningScene::checks() const { return state_->checks; }
const Robot& PlanningScene::robot() const { return state_->scratch.robot(); }
const GripperShape& PlanningScene::shape() const { return *state_->shape; }
int PlanningScene::target_body() const { return state_->target; }
const mjModel* PlanningScene::model() const { return state_->scratch.model(); }
const mjData* PlanningScene::data() const { return state_->scratch.data(); }

}  // namespace robocell
