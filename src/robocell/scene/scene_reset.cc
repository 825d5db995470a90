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

// Every servo that moves with the noise holds the new positions, whether the robot lists it or not.
void HoldNewPositions(const mjModel* model, mjData* data, const std::vector<bool>& moved) {
  for (int actuator = 0; actuator < model->nactuator; ++actuator) {
    if (ActsOn(model, data, actuator, moved)) Hold(model, data, actuator);
  }
}

bool IsZero(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == 0; });
}

void ApplyHomeNoise(const CompiledScene& compiled, mjData* data, uint64_t seed,
                    const std::string& context) {
  const mjModel* model = compiled.model();
  bool any = false;
  std::vector<bool> moved(static_cast<size_t>(model->nv));
  for (const RobotRecord& robot : compiled.robots()) {
    for (const auto& [group, noise] : robot.config.home_noise.entries()) {
      AddGroupNoise(model, data, robot, group, *noise, seed);
      if (IsZero(*noise)) continue;
      any = true;
      MarkDofs(model, robot, robot.config.move_groups.at(group), moved);
    }
  }
  if (!any) return;
  Guarded(context, data, [&] { mj_fwdPosition(model, data); });
  HoldNewPositions(model, data, moved);
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
  if (options.seed) ApplyHomeNoise(*s.compiled, s.data.data, *options.seed, s.context);
  s.poses_at = -1;
  SyncPoses();
  ResetContext reset{*this, options, info};
  const auto hooks = s.hooks;  // a hook may add or remove hooks
  for (const auto& [id, hook] : hooks) {
    hook(reset);
    open();  // a hook that closed the scene ends the reset
  }
  s.poses_at = -1;
  SyncPoses();
  const auto observers = s.observers;
  for (const auto& watch : observers) {
    if (const auto observer = watch.observer.lock()) observer->OnReset();
    open();
  }
  Forget(s.model(), s.data.data);
  Forward();
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
