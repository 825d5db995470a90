// Reset: restore, noise, bodies' poses, hooks, observers, forget, forward.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/function_name.h"
#include "robocell/base/log.h"
#include "robocell/base/rng.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/coupled_positions.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/step.h"
#include "robocell/scene/coupled_groups.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/scene/key_share.h"
#include "robocell/scene/require_keyframe.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/scene_state.h"

namespace robocell {
namespace {

// The keyframes of a reset by their numbers: `start`, then those that change parts of it.
struct StartKeys {
  int start = -1;  // -1: the model's default configuration
  struct Part {
    int key;
    internal::KeyShare share;  // the part's share of it
  };
  std::vector<Part> over = {};
};

int KeyOfNumber(const CompiledScene& compiled, int number, const std::string& context) {
  const std::vector<std::string> names = ElementNames(compiled.model(), mjOBJ_KEY);
  if (number >= 0 && number < static_cast<int>(names.size())) return number;
  throw ArgumentError(fmt::format("{}: there is no keyframe {}; the scene has {}: {}", context,
                                  number, names.size(), ListNames(names)));
}

std::vector<std::string> PartNames(const CompiledScene& compiled) {
  std::vector<std::string> names;
  for (const RobotRecord& robot : compiled.robots()) names.push_back(robot.name);
  for (const ObjectRecord& object : compiled.objects()) names.push_back(object.name);
  return names;
}

// Returns the keyframes of a part by their names in its own model.
std::vector<std::string> OwnNames(const CompiledScene& compiled, const std::string& part) {
  std::vector<std::string> names = {"home"};
  for (const CompiledScene::KeyOwner& owner : compiled.key_owners()) {
    if (owner.part == part && !owner.name.empty()) names.push_back(owner.name);
  }
  return names;
}

// Returns -1 if the part has no keyframe of that name.
int KeyOfPart(const CompiledScene& compiled, const std::string& part, const std::string& name) {
  const std::vector<CompiledScene::KeyOwner>& owners = compiled.key_owners();
  for (size_t i = 0; i < owners.size(); ++i) {
    if (owners[i].part == part && owners[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

// Returns the name of a part's keyframe; `own` are those that it has.
const std::string& NameOfKey(const PartKeyframe& key, const std::vector<std::string>& own,
                             const std::string& context) {
  const int* number = std::get_if<int>(&key);
  if (!number) return std::get<std::string>(key);
  if (*number >= 0 && *number < static_cast<int>(own.size()))
    return own[static_cast<size_t>(*number)];
  throw ArgumentError(fmt::format("{}: there is no keyframe {}; its model has {}: {}", context,
                                  *number, own.size(), ListNames(own)));
}

StartKeys KeysOfParts(const CompiledScene& compiled, const PartKeyframes& choice,
                      const std::string& context) {
  const std::vector<std::string> parts = PartNames(compiled);
  StartKeys keys{.start = compiled.home_key()};
  for (const auto& [part, chosen] : choice) {
    if (std::find(parts.begin(), parts.end(), part) == parts.end())
      throw NotFoundError(NoSuchName(context + ": keyframe", "part", part, parts));
    const std::string place = fmt::format("{} / '{}'", context, part);
    const std::string host = internal::HostOfPart(compiled, part);
    const std::vector<std::string> own = OwnNames(compiled, host);
    const std::string& name = NameOfKey(chosen, own, place);
    if (name == "home") continue;
    const int key = KeyOfPart(compiled, host, name);
    if (key < 0) throw NotFoundError(NoSuchName(place, "keyframe", name, own));
    keys.over.push_back({key, internal::ShareOfKeys(compiled, part)});
  }
  return keys;
}

// Parses "left: retract", a part's own keyframe as one text. The name of a part may have a colon.
std::optional<PartKeyframes> ChoiceOfText(const CompiledScene& compiled, const std::string& text) {
  size_t colon = text.find(':');
  for (const std::string& part : PartNames(compiled)) {
    if (text.starts_with(part + ':')) colon = std::max(colon, part.size());  // the longest
  }
  const size_t key = text.find_first_not_of(' ', colon == std::string::npos ? colon : colon + 1);
  if (colon == std::string::npos || key == std::string::npos) return std::nullopt;
  return PartKeyframes{{text.substr(0, colon), text.substr(key)}};
}

// Explains how to choose a part's own keyframe: one of that name, else any; "" without any.
std::string HowToChooseOfPart(const CompiledScene& compiled, const std::string& name) {
  const CompiledScene::KeyOwner* shown = nullptr;
  for (const CompiledScene::KeyOwner& owner : compiled.key_owners()) {
    if (owner.part.empty() || owner.name.empty()) continue;
    if (!shown || (owner.name == name && shown->name != name)) shown = &owner;
  }
  if (!shown) return "";
  return fmt::format(
      " The keyframe '{1}' of the model of '{0}' is \"{0}: {1}\", in Python also "
      "{{\"{0}\": \"{1}\"}}",
      shown->part, shown->name);
}

StartKeys KeysOfName(const CompiledScene& compiled, const std::string& name,
                     const std::string& context) {
  const int key = FindId(compiled.model(), mjOBJ_KEY, name);
  if (key >= 0) return {.start = key};
  if (const auto choice = ChoiceOfText(compiled, name))
    return KeysOfParts(compiled, *choice, context);
  throw NotFoundError(
      NoSuchName(context, "keyframe", name, ElementNames(compiled.model(), mjOBJ_KEY)) +
      HowToChooseOfPart(compiled, name));
}

// Copies the numbers of row `key` that are the part's and differ from those of row `start`; `each`
// of them share an entry of `own`.
void Overlay(const mjtNum* rows, int start, int key, mjtSize count, const std::vector<bool>& own,
             mjtNum* out, size_t each = 1) {
  const mjtNum* from = rows + start * static_cast<ptrdiff_t>(count);
  const mjtNum* to = rows + key * static_cast<ptrdiff_t>(count);
  for (mjtSize i = 0; i < count; ++i) {
    if (to[i] != from[i] && (own.empty() || own[static_cast<size_t>(i) / each])) out[i] = to[i];
  }
}

// Returns home if nothing is chosen. Throws ArgumentError for an unknown number, and NotFoundError
// with the nearest names for an unknown name; `context` names the scene.
StartKeys FindStartKeys(const CompiledScene& compiled, const std::optional<KeyframeChoice>& choice,
                        const std::string& context) {
  if (!choice) return {.start = compiled.home_key()};
  if (const int* number = std::get_if<int>(&*choice))
    return {.start = KeyOfNumber(compiled, *number, context)};
  if (const auto* name = std::get_if<std::string>(&*choice))
    return KeysOfName(compiled, *name, context);
  return KeysOfParts(compiled, std::get<PartKeyframes>(*choice), context);
}

// Restores a keyframe over another that has the differing values.
void RestoreKeys(const mjModel* model, mjData* data, const StartKeys& keys,
                 const std::string& context) {
  internal::Guarded(context, data, [&] {
    if (keys.start >= 0) {
      mj_resetDataKeyframe(model, data, keys.start);
    } else {
      mj_resetData(model, data);
    }
  });
  for (const auto& [key, own] : keys.over) {
    Overlay(model->key_qpos, keys.start, key, model->nq, own.qpos, data->qpos);
    Overlay(model->key_qvel, keys.start, key, model->nv, own.qvel, data->qvel);
    Overlay(model->key_act, keys.start, key, model->na, own.act, data->act);
    Overlay(model->key_ctrl, keys.start, key, model->nu, own.ctrl, data->ctrl);
    Overlay(model->key_mpos, keys.start, key, 3 * model->nmocap, own.mocap, data->mocap_pos, 3);
    Overlay(model->key_mquat, keys.start, key, 4 * model->nmocap, own.mocap, data->mocap_quat, 4);
  }
}

// Draws the noise of a group, one stream per robot and group. A joint of -1 has none.
std::vector<double> DrawNoise(const std::vector<int>& joints, const std::vector<double>& noise,
                              Rng rng) {
  std::vector<double> offsets(joints.size());
  for (size_t i = 0; i < joints.size(); ++i) {
    const double amount = noise.size() == 1 ? noise[0] : i < noise.size() ? noise[i] : 0;
    if (joints[i] >= 0) offsets[i] = rng.Uniform(-amount, amount);
  }
  return offsets;
}

bool IsZero(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == 0; });
}

// Moves joints only; marks the degrees of freedom whose position it changed.
void ApplyHomeNoise(const CompiledScene& compiled, mjData* data, uint64_t seed,
                    std::vector<bool>& moved) {
  const mjModel* model = compiled.model();
  for (const RobotRecord& robot : compiled.robots()) {
    for (const auto& [name, noise] : robot.config.home_noise.entries()) {
      const MoveGroupConfig& group = robot.config.move_groups.at(name);
      const std::vector<int> joints = internal::JointIds(model, robot, group.joints);
      const std::vector<double> offsets =
          DrawNoise(joints, *noise, Rng::Stream(seed, "home_noise", robot.name, name));
      internal::MoveCoupled(model, joints, offsets, data->qpos);
      if (!IsZero(*noise)) internal::MarkDofs(model, joints, moved);
    }
  }
}

void Forget(const mjModel* model, mjData* data) {
  std::fill_n(data->qacc_warmstart, model->nv, 0.0);
  std::fill_n(data->qfrc_applied, model->nv, 0.0);
  std::fill_n(data->xfrc_applied, 6 * model->nbody, 0.0);
}

// Set while hooks run, also if one of them throws.
class InHooks {
 public:
  explicit InHooks(bool& flag) : flag_(flag) { flag_ = true; }
  ~InHooks() { flag_ = false; }
  InHooks(const InHooks&) = delete;
  InHooks& operator=(const InHooks&) = delete;

 private:
  bool& flag_;
};

}  // namespace

ResetInfo Scene::Reset(const ResetOptions& options) {
  const std::shared_ptr<State> keep = state_;  // a hook may close the scene
  State& s = open();
  if (s.in_hooks) {
    throw Error(s.context +
                ": reset() in a reset hook, which would call the hook again; leave it out: what "
                "the hook sets is what the reset ends with");
  }
  for (const auto& [body, pose] : options.body_poses) s.RequireMovable(body, true);
  const ResetInfo info = s.RestoreStart(*this, options);
  try {
    s.CallResetHooks(*this, options, info);
  } catch (...) {
    // A partial change by hooks is not a valid start: the reset goes on as if there were no hooks.
    if (!s.closed) {
      s.RestoreStart(*this, options);
      try {
        s.FinishReset(*this);
      } catch (const std::exception& error) {  // the hook's error is the one to throw
        LogWarn(fmt::format("{}: while undoing what a reset hook had begun: {}", s.context,
                            error.what()));
      }
    }
    throw;
  }
  s.FinishReset(*this);
  return info;
}

ResetInfo Scene::State::RestoreStart(Scene& scene, const ResetOptions& options) {
  ResetInfo info;
  StartKeys keys;
  // One that is not used must still be there.
  if (options.keyframe && !options.use_keyframe)
    FindStartKeys(*compiled, options.keyframe, context);
  if (options.use_keyframe) {
    keys = FindStartKeys(*compiled, options.keyframe, context);
    info = {true, keys.start};
  }
  RestoreKeys(model(), data.data, keys, context);
  ResetPool();
  // The default configuration has controls of 0, which only hold joints at 0.
  std::vector<bool> moved(static_cast<size_t>(model()->nv), !info.used_keyframe);
  if (options.seed) ApplyHomeNoise(*compiled, data.data, *options.seed, moved);
  PutBodies(options.body_poses);
  poses_at = -1;
  scene.SyncPoses();
  internal::HoldMoved(model(), data.data, moved, context);
  return info;
}

void Scene::State::CallResetHooks(Scene& scene, const ResetOptions& options,
                                  const ResetInfo& info) {
  const InHooks scope(in_hooks);
  ResetContext reset{scene, options, info};
  const auto present = hooks;  // a hook may add or remove hooks
  for (const auto& [id, hook] : present) {
    hook(reset);
    scene.open();  // a hook that closed the scene ends the reset
  }
  if (present.empty()) return;
  // Hooks may have removed a body with its object, or parked it.
  for (const auto& [body, pose] : options.body_poses) PutBody(RequireMovable(body), pose);
  poses_at = -1;
}

void Scene::State::FinishReset(Scene& scene) {
  scene.SyncPoses();
  const auto present = observers;
  std::exception_ptr failed;
  const auto notify = [&](void (SceneObserver::*what)()) {
    for (const auto& watch : present) {
      try {
        if (const auto observer = watch.observer.lock()) (observer.get()->*what)();
      } catch (...) {  // notify the others anyway
        if (!failed) failed = std::current_exception();
      }
      scene.open();
    }
  };
  internal::ForgetPastCtrl(model(), data.data);  // controllers know better of theirs
  notify(&SceneObserver::OnReset);
  Forget(model(), data.data);
  scene.Forward();
  notify(&SceneObserver::OnResetDone);
  if (failed) std::rethrow_exception(failed);
}

void internal::RequireKeyframe(const Scene& scene, const KeyframeChoice& keyframe) {
  FindStartKeys(*scene.compiled(), keyframe, "scene '" + scene.name() + "'");
}

std::vector<std::string> Scene::keyframes() const {
  return ElementNames(open().model(), mjOBJ_KEY);
}

const std::map<int, ResetHook>& Scene::reset_hooks() const { return state_->hooks; }

void Scene::ClearResetHooks() { state_->hooks.clear(); }

int Scene::AddResetHook(ResetHook hook) {
  State& s = open();
  if (!hook) {
    throw ArgumentError(s.context + ": a reset hook cannot be empty; to take one away: " +
                        internal::CppAndPythonName("RemoveResetHook"));
  }
  s.hooks.emplace(s.next_hook, std::move(hook));
  return s.next_hook++;
}

void Scene::RemoveResetHook(int id) {
  State& s = open();
  if (s.hooks.erase(id) == 1) return;
  std::vector<std::string> ids;
  for (const auto& [known, hook] : s.hooks) ids.push_back(std::to_string(known));
  throw NotFoundError(
      fmt::format("{}: there is no reset hook {}. Ids of those there are, as AddResetHook (in "
                  "Python on_reset) returned them: {}",
                  s.context, id, ids.empty() ? "none" : ListNames(ids)));
}

}  // namespace robocell
