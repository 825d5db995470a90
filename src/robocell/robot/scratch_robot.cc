#include "robocell/robot/scratch_robot.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

bool IsStill(const mjModel* m, int body) { return m->body_dofnum[m->body_weldid[body]] == 0; }

}  // namespace

bool MayCollide(const mjModel* m, int a, int b) {
  if (!(m->geom_contype[a] & m->geom_conaffinity[b]) &&
      !(m->geom_contype[b] & m->geom_conaffinity[a]))
    return false;
  const int first = std::min(m->geom_bodyid[a], m->geom_bodyid[b]);
  const int second = std::max(m->geom_bodyid[a], m->geom_bodyid[b]);
  if (IsStill(m, first) && IsStill(m, second)) return false;
  const int* excluded = m->exclude_signature;
  if (std::find(excluded, excluded + m->nexclude, (first << 16) + second) != excluded + m->nexclude)
    return false;
  const int link = m->body_weldid[first], other = m->body_weldid[second];
  if (link == other) return false;
  const auto above = [&](int l) { return m->body_weldid[m->body_parentid[l]]; };
  const bool neighbours = link != 0 && other != 0 && (above(link) == other || above(other) == link);
  return !neighbours || (m->opt.disableflags & mjDSBL_FILTERPARENT) != 0;
}

struct ScratchRobot::State {
  State(const Robot& r, std::string_view after_changes)
      : robot(r),
        remedy(after_changes),
        compiled(r.scene().compiled()),
        model(*r.scene().model()),
        data(MakeData(&model)) {}

  void RequireSameModel() const;
  void CopyFilters();
  bool FindContacts();
  void PairBoxes();
  void PairBox(int own);
  bool AreBoxes(int a, int b) const {
    return model.geom_type[a] == mjGEOM_BOX && model.geom_type[b] == mjGEOM_BOX;
  }
  void MeasureBoxes();

  Robot robot;
  std::string remedy;
  std::shared_ptr<CompiledScene> compiled;
  mjModel model;  // shares the arrays of the scene's; contact margin and filters are its own
  std::vector<int> contype, conaffinity;  // masks of objects of the pool at the last update
  DataPtr data;
  std::vector<char> is_robot, counts;    // per geom; `counts`: it is not ignored
  std::vector<char> is_held;             // per geom
  std::vector<int> arm;                  // addresses in qpos
  std::vector<JointFollower> followers;  // of the arm's joints
  std::set<std::pair<int, int>> always_touching;
  std::set<std::pair<int, int>> boxes;  // the robot's that count, and others, that may collide
  std::vector<Touch> touches;
};

void ScratchRobot::State::RequireSameModel() const {
  if (robot.scene().compiled() == compiled) return;
  throw Error("scene '" + robot.scene().name() +
              "': objects were added or removed since the robot's surroundings were looked at; " +
              remedy);
}

void ScratchRobot::State::CopyFilters() {
  const mjModel* m = robot.scene().model();
  contype.assign(m->geom_contype, m->geom_contype + m->ngeom);
  conaffinity.assign(m->geom_conaffinity, m->geom_conaffinity + m->ngeom);
  model.geom_contype = contype.data();
  model.geom_conaffinity = conaffinity.data();
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

void ScratchRobot::State::PairBoxes() {
  boxes.clear();
  if (model.opt.o_margin == 0) return;  // contacts of overlapping boxes are correct
  if ((model.opt.disableflags & (mjDSBL_CONTACT | mjDSBL_CONSTRAINT)) != 0) return;
  for (const int own : robot.collision_geom_ids()) PairBox(own);
  for (int g = 0; g < model.ngeom; ++g) {
    if (is_held[g]) PairBox(g);
  }
}

void ScratchRobot::State::PairBox(int own) {
  for (int g = 0; g < model.ngeom; ++g) {
    if (!is_robot[g] && !is_held[g] && AreBoxes(own, g) && MayCollide(&model, own, g))
      boxes.emplace(own, g);
  }
}

// Contacts with a margin report wrong distances of separated boxes, or miss them.
void ScratchRobot::State::MeasureBoxes() {
  const double horizon = model.opt.o_margin;
  mjData* d = data.get();
  for (const std::pair<int, int>& pair : boxes) {  // no names for the two: clang 14 captures none
    const int own = pair.first, other = pair.second;
    const double reach = model.geom_rbound[own] + model.geom_rbound[other] + horizon;
    if (mju_dist3(d->geom_xpos + 3 * own, d->geom_xpos + 3 * other) >= reach) continue;
    const double distance = Guarded("planning: distance of two boxes", d, [&] {
      return mj_geomDistance(&model, d, own, other, horizon, nullptr);
    });
    if (distance >= 0 && distance < horizon) touches.push_back({own, other, distance, false});
  }
}

ScratchRobot::ScratchRobot(const Robot& robot, double horizon, std::string_view remedy)
    : state_(std::make_unique<State>(robot, remedy)) {
  State& s = *state_;
  mjModel* m = &s.model;
  // Contacts are reported up to this distance, whatever margins the geoms have.
  m->opt.enableflags |= mjENBL_OVERRIDE;
  m->opt.o_margin = horizon;
  // Several contacts of two separate geoms may leave out the nearest points.
  m->opt.disableflags |= mjDSBL_MULTICCD;
  s.is_robot.assign(m->ngeom, 0);
  s.counts.assign(m->ngeom, 1);
  s.is_held.assign(m->ngeom, 0);
  for (const int g : robot.geom_ids()) {
    s.is_robot[g] = 1;
    s.counts[g] = 0;
  }
  for (const int g : robot.collision_geom_ids()) s.counts[g] = 1;
  std::vector<int> joints;
  for (const ChainJoint& joint : robot.chain().joints()) {
    s.arm.push_back(joint.qpos_address);
    joints.push_back(joint.id);
  }
  s.followers = FollowersOf(&s.model, joints);
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
  std::ranges::fill(s.is_held, 0);
  s.CopyFilters();  // objects of the pool may have been added or removed
  s.PairBoxes();
  s.FindContacts();
  s.always_touching.clear();
  for (int c = 0; c < s.data->ncon; ++c) {
    const auto [a, b] = s.data->contact[c].geom;
    if (a >= 0 && b >= 0 && s.is_robot[a] && s.is_robot[b] && s.data->contact[c].dist < 0)
      s.always_touching.insert({a, b});
  }
}

void ScratchRobot::SetArm(std::span<const double> q) {
  State& s = *state_;
  for (size_t i = 0; i < s.arm.size(); ++i) s.data->qpos[s.arm[i]] = q[i];
  for (const JointFollower& f : s.followers)
    s.data->qpos[s.model.jnt_qposadr[f.joint]] = f.of_leader.at(q[f.leader]);
}

void ScratchRobot::Hold(int body) {
  State& s = *state_;
  for (int g = 0; g < s.model.ngeom; ++g)
    s.is_held[g] = body >= 0 && IsInSubtree(&s.model, s.model.geom_bodyid[g], body) ? 1 : 0;
  s.PairBoxes();
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
    if (a < 0 || b < 0 || !s.counts[a] || !s.counts[b]) continue;
    const bool a_own = s.is_robot[a] || s.is_held[a], b_own = s.is_robot[b] || s.is_held[b];
    if (!a_own && !b_own) continue;
    if (a_own && b_own && (s.is_held[a] || s.is_held[b])) continue;  // the hand and its held object
    const double distance = s.data->contact[c].dist;
    const bool itself = a_own && b_own;
    if (itself && (distance >= 0 || s.always_touching.contains({a, b}))) continue;
    const auto [own, other] = a_own ? std::pair(a, b) : std::pair(b, a);
    if (distance >= 0 && s.boxes.contains({own, other})) continue;  // measured below
    s.touches.push_back({own, other, distance, itself});
  }
  s.MeasureBoxes();
  return all;
}

const std::vector<ScratchRobot::Touch>& ScratchRobot::touches() const { return state_->touches; }
const Robot& ScratchRobot::robot() const { return state_->robot; }
const mjModel* ScratchRobot::model() const { return &state_->model; }
const mjData* ScratchRobot::data() const { return state_->data.get(); }

}  // namespace robocell::internal
