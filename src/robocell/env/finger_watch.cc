#include "robocell/env/finger_watch.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/mujoco/names.h"
#include "robocell/robot/gripper_group.h"

namespace robocell::internal {
namespace {

constexpr double kWatched = 0.05;     // s, a window
constexpr double kStillShare = 1e-3;  // share of the travel, within a window
constexpr double kDrift = 5e-3;       // share of the travel that ends the rest of fingers
constexpr int kLongWindows = 4;       // watched windows of fingers away from their target
constexpr double kThere = 0.05;       // share of the opening
constexpr double kFreeTurn = 1, kFreeSlide = 0.1;  // travel of joints without limits, rad and m

// Collects the joints between a finger and the hand.
void AddPath(const mjModel* m, int from, int hand, std::vector<int>& joints) {
  for (int body = from; body > 0 && body != hand; body = m->body_parentid[body]) {
    for (int i = 0; i < m->body_jntnum[body]; ++i) joints.push_back(m->body_jntadr[body] + i);
  }
}

}  // namespace

FingerWatch::FingerWatch(Robot robot) : robot_(std::move(robot)) { Begin(0); }

void FingerWatch::Bind() {
  const Scene scene = robot_.scene();
  if (generation_ == scene.generation()) return;
  generation_ = scene.generation();
  const mjModel* m = scene.model();
  std::vector<int> ids;
  for (const std::string& name : gripper().joint_names())
    ids.push_back(FindId(m, mjOBJ_JOINT, name));
  if (const auto* fingers = dynamic_cast<const ActuatedGripper*>(&gripper())) {
    for (const int i : {0, 1}) AddPath(m, fingers->finger(i).body, fingers->hand_body(), ids);
  }
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  joints_.clear();
  for (const int id : ids) {
    if (id < 0 || (m->jnt_type[id] != mjJNT_HINGE && m->jnt_type[id] != mjJNT_SLIDE)) continue;
    const double width = m->jnt_range[2 * id + 1] - m->jnt_range[2 * id];
    const double free = m->jnt_type[id] == mjJNT_HINGE ? kFreeTurn : kFreeSlide;
    joints_.push_back({id, m->jnt_limited[id] && width > 0 ? width : free});
  }
}

void FingerWatch::Look(std::span<double> out) const {
  const Scene scene = robot_.scene();
  const mjModel* m = scene.model();
  for (size_t i = 0; i < joints_.size(); ++i)
    out[i] = scene.data()->qpos[m->jnt_qposadr[joints_[i].id]] / joints_[i].scale;
  out.back() = gripper().opening();
}

void FingerWatch::Begin(double time) {
  Bind();
  now_.resize(joints_.size() + 1);
  memory_.window.resize(now_.size());
  memory_.still_windows = 0;
  memory_.is_still = false;
  memory_.window_start = time;
  Look(memory_.window);
}

double FingerWatch::Moved() {
  Look(now_);
  double most = 0;
  for (size_t i = 0; i < now_.size(); ++i)
    most = std::max(most, std::abs(now_[i] - memory_.window[i]));
  return most;
}

bool FingerWatch::IsWhereItEnds(double opening) const {
  return std::abs(gripper().opening() - opening) < kThere || gripper().is_grasping();
}

bool FingerWatch::IsStill(double time, double opening) {
  if (memory_.is_still) {
    if (Moved() < kDrift) return true;
    memory_.is_still = false;
    memory_.still_windows = 0;
  } else {
    if (time - memory_.window_start < kWatched) return false;
    memory_.still_windows = Moved() < kStillShare ? memory_.still_windows + 1 : 0;
    const int needed = IsWhereItEnds(opening) ? 1 : kLongWindows;
    memory_.is_still = memory_.still_windows >= needed;
  }
  memory_.window_start = time;
  memory_.window = now_;
  return memory_.is_still;
}

}  // namespace robocell::internal
