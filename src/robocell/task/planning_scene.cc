#include "robocell/task/planning_scene.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/tree.h"
#include "robocell/task/geom_extent.h"

namespace robocell {

struct PlanningScene::State {
  State(Scene s, Robot r, std::shared_ptr<const GripperShape> g)
      : scene(std::move(s)),
        robot(std::move(r)),
        shape(std::move(g)),
        compiled(scene.compiled()),
        model(*scene.model()),
        data(MakeData(&model)) {}

  void RequireSameModel() const {
    if (scene.compiled() == compiled) return;
    throw Error("scene '" + scene.name() +
                "': objects were added or removed since the robot's motion was planned in it; "
                "begin planning again");
  }
  void Place(const JointVector& q, double gap);
  // False when there were more contacts than the engine has room for, so that some are missing.
  bool FindContacts();

  Scene scene;
  Robot robot;
  std::shared_ptr<const GripperShape> shape;
  std::shared_ptr<CompiledScene> compiled;
  mjModel model;  // shares the arrays of the scene's; only the contact margin differs
  DataPtr data;
  int target = -1;
  std::vector<char> is_robot, counts, is_target;  // per geom; `counts`: it is not overlooked
  std::vector<int> arm, fingers;                  // addresses in qpos
  std::vector<double> finger_values;
  std::set<std::pair<int, int>> always_touching;  // geoms of the robot
  int checks = 0;
  std::array<int, 2> in_the_way = {};
};

PlanningScene::PlanningScene(Scene scene, Robot robot, const std::string& target_body,
                             std::shared_ptr<const GripperShape> shape)
    : state_(std::make_unique<State>(std::move(scene), std::move(robot), std::move(shape))) {
  State& s = *state_;
  mjModel* m = &s.model;
  // Contacts are reported from this distance on, whatever the geoms ask for.
  m->opt.enableflags |= mjENBL_OVERRIDE;
  m->opt.o_margin = kMostClearance + 0.005;
  s.target = RequireId(m, mjOBJ_BODY, target_body, "scene '" + s.scene.name() + "'");
  s.is_robot.assign(m->ngeom, 0);
  s.is_target.assign(m->ngeom, 0);
  s.counts.assign(m->ngeom, 1);
  for (const int g : s.robot.geom_ids()) {
    s.is_robot[g] = 1;
    s.counts[g] = 0;
  }
  for (const int g : s.robot.collision_geom_ids()) s.counts[g] = 1;
  for (int g = 0; g < m->ngeom; ++g) s.is_target[g] = IsInSubtree(m, m->geom_bodyid[g], s.target);
  for (const ChainJoint& joint : s.robot.chain().joints()) s.arm.push_back(joint.qpos_address);
  for (const std::string& name : s.shape->joint_names()) {
    const int joint =
        RequireId(m, mjOBJ_JOINT, s.robot.prefix() + name, "robot '" + s.robot.name() + "'");
    s.fingers.push_back(m->jnt_qposadr[joint]);
  }
  s.finger_values.resize(s.fingers.size());
  Update();
}

PlanningScene::~PlanningScene() = default;

void PlanningScene::State::Place(const JointVector& q, double gap) {
  for (size_t i = 0; i < arm.size(); ++i) data->qpos[arm[i]] = q[static_cast<int>(i)];
  shape->JointsAt(gap, finger_values);
  for (size_t i = 0; i < fingers.size(); ++i) data->qpos[fingers[i]] = finger_values[i];
}

bool PlanningScene::State::FindContacts() {
  const mjModel* m = &model;
  mjData* d = data.get();
  const int before = d->warning[mjWARN_CONTACTFULL].number;
  Guarded("planning: collisions", d, [&] {
    mj_kinematics(m, d);
    mj_comPos(m, d);
    mj_collision(m, d);
  });
  return d->warning[mjWARN_CONTACTFULL].number == before;
}

void PlanningScene::Update() {
  State& s = *state_;
  s.RequireSameModel();
  const mjData* from = s.scene.data();
  mju_copy(s.data->qpos, from->qpos, s.model.nq);
  mju_copy(s.data->mocap_pos, from->mocap_pos, 3 * s.model.nmocap);
  mju_copy(s.data->mocap_quat, from->mocap_quat, 4 * s.model.nmocap);
  s.FindContacts();
  s.always_touching.clear();
  for (int c = 0; c < s.data->ncon; ++c) {
    const auto [a, b] = s.data->contact[c].geom;
    if (a >= 0 && b >= 0 && s.is_robot[a] && s.is_robot[b] && s.data->contact[c].dist < 0)
      s.always_touching.insert({a, b});
  }
}

bool PlanningScene::IsFree(const JointVector& q, const FreedomDemand& demand) {
  State& s = *state_;
  s.RequireSameModel();
  ++s.checks;
  s.Place(q, demand.gap);
  s.in_the_way = {};
  if (!s.FindContacts()) return false;  // what is missing may be in the way
  for (int c = 0; c < s.data->ncon; ++c) {
    const auto [a, b] = s.data->contact[c].geom;
    if (a < 0 || b < 0 || (!s.is_robot[a] && !s.is_robot[b])) continue;
    if (!s.counts[a] || !s.counts[b]) continue;
    const double distance = s.data->contact[c].dist;
    const bool itself = s.is_robot[a] && s.is_robot[b];
    const bool fine = itself ? distance >= 0 || s.always_touching.contains({a, b})
                             : distance >= demand.clearance ||
                                   (demand.touch_target && (s.is_target[a] || s.is_target[b]));
    if (fine) continue;
    s.in_the_way = {s.model.geom_bodyid[s.is_robot[a] ? a : b],
                    s.model.geom_bodyid[s.is_robot[a] ? b : a]};
    return false;
  }
  return true;
}

std::array<int, 2> PlanningScene::in_the_way() const { return state_->in_the_way; }
int PlanningScene::checks() const { return state_->checks; }
const Robot& PlanningScene::robot() const { return state_->robot; }
const GripperShape& PlanningScene::shape() const { return *state_->shape; }
int PlanningScene::target_body() const { return state_->target; }
const mjModel* PlanningScene::model() const { return &state_->model; }
const mjData* PlanningScene::data() const { return state_->data.get(); }

}  // namespace robocell
