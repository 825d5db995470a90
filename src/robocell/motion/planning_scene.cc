#include "robocell/motion/planning_scene.h"

#include <mujoco/mujoco.h>

#include <utility>
#include <vector>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/scratch_robot.h"

namespace robocell {

struct PlanningScene::State {
  State(const Robot& robot, std::shared_ptr<const GripperShape> g)
      : scratch(robot, kMostClearance + 0.005, "begin planning again"), shape(std::move(g)) {}

  void Place(const JointVector& q, double gap);

  ScratchRobot scratch;
  std::shared_ptr<const GripperShape> shape;
  int target = -1;
  std::vector<char> is_target;  // per geom
  std::vector<int> fingers;     // addresses in qpos
  std::vector<double> finger_values;
  int checks = 0;
  std::array<int, 2> in_the_way = {};
};

PlanningScene::PlanningScene(const Scene& scene, const Robot& robot, const std::string& target_body,
                             std::shared_ptr<const GripperShape> shape)
    : state_(std::make_unique<State>(robot, std::move(shape))) {
  State& s = *state_;
  const mjModel* m = s.scratch.model();
  s.target = RequireId(m, mjOBJ_BODY, target_body, "scene '" + scene.name() + "'");
  s.is_target.assign(m->ngeom, 0);
  for (int g = 0; g < m->ngeom; ++g) s.is_target[g] = IsInSubtree(m, m->geom_bodyid[g], s.target);
  for (const std::string& name : s.shape->joint_names()) {
    const int joint =
        RequireId(m, mjOBJ_JOINT, robot.prefix() + name, "robot '" + robot.name() + "'");
    s.fingers.push_back(m->jnt_qposadr[joint]);
  }
  s.finger_values.resize(s.fingers.size());
}

PlanningScene::~PlanningScene() = default;

void PlanningScene::State::Place(const JointVector& q, double gap) {
  scratch.SetArm(q);
  shape->JointsAt(gap, finger_values);
  for (size_t i = 0; i < fingers.size(); ++i) scratch.qpos()[fingers[i]] = finger_values[i];
}

void PlanningScene::Update() { state_->scratch.Update(); }

bool PlanningScene::IsFree(const JointVector& q, const FreedomDemand& demand) {
  State& s = *state_;
  ++s.checks;
  s.Place(q, demand.gap);
  s.in_the_way = {};
  if (!s.scratch.FindTouches()) return false;  // what is missing may be in the way
  for (const ScratchRobot::Touch& touch : s.scratch.touches()) {
    if (!touch.itself) {
      const bool wanted = s.is_target[touch.own_geom] || s.is_target[touch.other_geom];
      if (touch.distance >= demand.clearance || (demand.touch_target && wanted)) continue;
    }
    const mjModel* m = s.scratch.model();
    s.in_the_way = {m->geom_bodyid[touch.own_geom], m->geom_bodyid[touch.other_geom]};
    return false;
  }
  return true;
}

std::array<int, 2> PlanningScene::in_the_way() const { return state_->in_the_way; }
int PlanningScene::checks() const { return state_->checks; }
const Robot& PlanningScene::robot() const { return state_->scratch.robot(); }
const GripperShape& PlanningScene::shape() const { return *state_->shape; }
int PlanningScene::target_body() const { return state_->target; }
const mjModel* PlanningScene::model() const { return state_->scratch.model(); }
const mjData* PlanningScene::data() const { return state_->scratch.data(); }

}  // namespace robocell
