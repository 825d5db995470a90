#include "robocell/robot/scratch_robot.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/owners.h"

namespace robocell {

struct ScratchRobot::State {
  State(const Robot& r, std::string_view after_changes)
      : robot(r),
        remedy(after_changes),
        compiled(r.scene().compiled()),
        model(*r.scene().model()),
        data(MakeData(&model)) {}

  void RequireSameModel() const;
  bool FindContacts();

  Robot robot;
  std::string remedy;
  std::shared_ptr<CompiledScene> compiled;
  mjModel model;  // shares the arrays of the scene's; only the contact margin differs
  DataPtr data;
  std::vector<char> is_robot, counts;  // per geom; `counts`: it is not overlooked
  std::vector<int> arm;                // addresses in qpos
  std::set<std::pair<int, int>> always_touching;
  std::vector<Touch> touches;
};

void ScratchRobot::State::RequireSameModel() const {
  if (robot.scene().compiled() == compiled) return;
  throw Error("scene '" + robot.scene().name() +
              "': objects were added or removed since the robot's surroundings were looked at; " +
              remedy);
}

bool ScratchRobot::State::FindContacts() {
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

ScratchRobot::ScratchRobot(const Robot& robot, double horizon, std::string_view remedy)
    : state_(std::make_unique<State>(robot, remedy)) {
  State& s = *state_;
  mjModel* m = &s.model;
  // Contacts are reported from this distance on, whatever the geoms ask for.
  m->opt.enableflags |= mjENBL_OVERRIDE;
  m->opt.o_margin = horizon;
  s.is_robot.assign(m->ngeom, 0);
  s.counts.assign(m->ngeom, 1);
  for (const int g : robot.geom_ids()) {
    s.is_robot[g] = 1;
    s.counts[g] = 0;
  }
  for (const int g : robot.collision_geom_ids()) s.counts[g] = 1;
  for (const ChainJoint& joint : robot.chain().joints()) s.arm.push_back(joint.qpos_address);
  Update();
}

ScratchRobot::~ScratchRobot() = default;

void ScratchRobot::Update() {
  State& s = *state_;
  s.RequireSameModel();
  const mjData* from = s.robot.scene().data();
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

void ScratchRobot::SetArm(std::span<const double> q) {
  for (size_t i = 0; i < state_->arm.size(); ++i) state_->data->qpos[state_->arm[i]] = q[i];
}

std::span<double> ScratchRobot::qpos() {
  return {state_->data->qpos, static_cast<size_t>(state_->model.nq)};
}

bool ScratchRobot::FindTouches() {
  State& s = *state_;
  s.RequireSameModel();
  s.touches.clear();
  const bool all = s.FindContacts();
  for (int c = 0; c < s.data->ncon; ++c) {
    const auto [a, b] = s.data->contact[c].geom;
    if (a < 0 || b < 0 || (!s.is_robot[a] && !s.is_robot[b])) continue;
    if (!s.counts[a] || !s.counts[b]) continue;
    const double distance = s.data->contact[c].dist;
    const bool itself = s.is_robot[a] && s.is_robot[b];
    if (itself && (distance >= 0 || s.always_touching.contains({a, b}))) continue;
    const auto [own, other] = s.is_robot[a] ? std::pair(a, b) : std::pair(b, a);
    s.touches.push_back({own, other, distance, itself});
  }
  return all;
}

const std::vector<ScratchRobot::Touch>& ScratchRobot::touches() const { return state_->touches; }
const Robot& ScratchRobot::robot() const { return state_->robot; }
const mjModel* ScratchRobot::model() const { return &state_->model; }
const mjData* ScratchRobot::data() const { return state_->data.get(); }

}  // namespace robocell
