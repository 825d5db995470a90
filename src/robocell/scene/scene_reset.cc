// Reset: restore, noise, hooks, observers, forget, forward.
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/step.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/scene/scene_state.h"

namespace robocell {
namespace {

void Restore(const mjModel* model, mjData* data, const ResetInfo& info,
             const std::string& context) {
  Guarded(context, data, [&] {
    if (info.used_keyframe) {
      mj_resetDataKeyframe(model, data, info.keyframe);
    } else {
      mj_resetData(model, data);
    }
  });
}

void AddNoise(const mjModel* model, mjData* data, int joint, double noise, Rng& rng) {
  const double offset =
      rng.Uniform(-noise, noise);  // drawn in any case: the stream's order is the list's
  if (model->jnt_type[joint] != mjJNT_HINGE && model->jnt_type[joint] != mjJNT_SLIDE) return;
  mjtNum& q = data->qpos[model->jnt_qposadr[joint]];
  q += offset;
  const mjtNum* range = model->jnt_range + 2 * joint;
  if (model->jnt_limited[joint]) q = std::clamp(q, range[0], range[1]);
}

// Uniform noise around where the group is, one stream per robot and group.
void AddGroupNoise(const mjModel* model, mjData* data, const RobotRecord& robot,
                   const std::string& group, const std::vector<double>& noise, uint64_t seed) {
  Rng rng = Rng::Stream(seed, "home_noise", robot.name, group);
  const NameList& joints = robot.config.move_groups.at(group).joints;
  for (size_t i = 0; i < joints.size(); ++i) {
    const double amount = noise.size() == 1 ? noise[0] : i < noise.size() ? noise[i] : 0;
    const int joint = FindId(model, mjOBJ_JOINT, robot.prefix + joints[i]);
    if (joint >= 0) AddNoise(model, data, joint, amount, rng);
  }
}

bool IsZero(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == 0; });
}

// Moves joints only; marks the degrees of freedom whose position it changed.
void ApplyHomeNoise(const CompiledScene& compiled, mjData* data, uint64_t seed,
                    std::vector<bool>& moved) {
  const mjModel* model = compiled.model();
  for (const RobotRecord& robot : compiled.robots()) {
    for (const auto& [group, noise] : robot.config.home_noise.entries()) {
      AddGroupNoise(model, data, robot, group, *noise, seed);
      if (!IsZero(*noise)) MarkDofs(model, robot, robot.config.move_groups.at(group), moved);
    }
  }
}

// Every servo that moves with the noise holds the new positions, whether the robot lists it or not.
// Poses have to be those of the positions.
void HoldNewPositions(const mjModel* model, mjData* data, const std::vector<bool>& moved,
                      const std::string& context) {
  if (std::find(moved.begin(), moved.end(), true) == moved.end()) return;
  // All that the length of an actuator depends on; contacts and masses it does not.
  Guarded(context, data, [&] {
    mj_tendon(model, data);
    mj_transmission(model, data);
  });
  for (int actuator = 0; actuator < model->nactuator; ++actuator) {
    if (ActsOn(model, data, actuator, moved)) Hold(model, data, actuator);
  }
}

void Forget(const mjModel* model, mjData* data) {
  std::fill_n(data->qacc_warmstart, model->nv, 0.0);
  std::fill_n(data->qfrc_applied, model->nv, 0.0);
  std::fill_n(data->xfrc_applied, 6 * model->nbody, 0.0);
}

}  // namespace

ResetInfo Scene::Reset(const ResetOptions& options) {
  State& s = open();
  ResetInfo info;
  if (options.use_keyframe) {
    info = {true, options.keyframe.value_or(s.compiled->home_key())};
    if (info.keyframe < 0 || info.keyframe >= s.model()->nkey) {
      throw ArgumentError(s.context + ": there is no keyframe " + std::to_string(info.keyframe) +
                          "; the scene has " + std::to_string(s.model()->nkey));
    }
  }
  Restore(s.model(), s.data.data, info, s.context);
  s.ResetPool();
  std::vector<bool> moved(static_cast<size_t>(s.model()->nv));
  if (options.seed) ApplyHomeNoise(*s.compiled, s.data.data, *options.seed, moved);
  s.poses_at = -1;
  SyncPoses();
  HoldNewPositions(s.model(), s.data.data, moved, s.context);
  ResetContext reset{*this, options, info};
  const auto hooks = s.hooks;  // a hook may add or remove hooks
  for (const auto& [id, hook] : hooks) {
    hook(reset);
    open();  // a hook that closed the scene ends the reset
  }
  if (!hooks.empty()) s.poses_at = -1;
  SyncPoses();
  const auto observers = s.observers;
  for (const auto& watch : observers) {
    if (const auto observer = watch.observer.lock()) observer->OnReset();
    open();
  }
  Forget(s.model(), s.data.data);
  Forward();
  for (const auto& watch : observers) {
    if (const auto observer = watch.observer.lock()) observer->OnResetDone();
    open();
  }
  return info;
}

const std::map<int, ResetHook>& Scene::reset_hooks() const { return state_->hooks; }

void Scene::ClearResetHooks() { state_->hooks.clear(); }

int Scene::AddResetHook(ResetHook hook) {
  State& s = open();
  s.hooks.emplace(s.next_hook, std::move(hook));
  return s.next_hook++;
}

void Scene::RemoveResetHook(int id) { open().hooks.erase(id); }

}  // namespace robocell
