#include "robocell/scene/reset_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"

namespace robocell {
namespace {

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

// The part in whose model a robot is: itself, unless it says part_of.
std::string HostOf(const CompiledScene& compiled, const std::string& part) {
  const List<RobotSpec>& specs = compiled.spec().robots;
  for (size_t i = 0; i < specs.size() && i < compiled.robots().size(); ++i) {
    if (compiled.robots()[i].name == part && !specs[i].part_of.empty()) return specs[i].part_of;
  }
  return part;
}

// The keyframes of a part, as its own model calls them.
std::vector<std::string> OwnNames(const CompiledScene& compiled, const std::string& part) {
  std::vector<std::string> names = {"home"};
  for (const CompiledScene::KeyOwner& owner : compiled.key_owners()) {
    if (owner.part == part && !owner.name.empty()) names.push_back(owner.name);
  }
  return names;
}

// -1 when the part has none of that name.
int KeyOfPart(const CompiledScene& compiled, const std::string& part, const std::string& name) {
  const std::vector<CompiledScene::KeyOwner>& owners = compiled.key_owners();
  for (size_t i = 0; i < owners.size(); ++i) {
    if (owners[i].part == part && owners[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

StartKeys KeysOfParts(const CompiledScene& compiled,
                      const std::map<std::string, std::string>& choice,
                      const std::string& context) {
  const std::vector<std::string> parts = PartNames(compiled);
  StartKeys keys{.start = compiled.home_key()};
  for (const auto& [part, name] : choice) {
    if (std::find(parts.begin(), parts.end(), part) == parts.end())
      throw NotFoundError(NoSuchName(context + ": keyframe", "part", part, parts));
    if (name == "home") continue;
    const int key = KeyOfPart(compiled, HostOf(compiled, part), name);
    if (key < 0) {
      throw NotFoundError(NoSuchName(fmt::format("{} / '{}'", context, part), "keyframe", name,
                                     OwnNames(compiled, HostOf(compiled, part))));
    }
    keys.over.push_back(key);
  }
  return keys;
}

// Copies the numbers of row `key` that differ from those of row `start`.
void Overlay(const mjtNum* rows, int start, int key, mjtSize count, mjtNum* out) {
  const mjtNum* from = rows + start * static_cast<ptrdiff_t>(count);
  const mjtNum* to = rows + key * static_cast<ptrdiff_t>(count);
  for (mjtSize i = 0; i < count; ++i) {
    if (to[i] != from[i]) out[i] = to[i];
  }
}

}  // namespace

StartKeys FindStartKeys(const CompiledScene& compiled, const std::optional<KeyframeChoice>& choice,
                        const std::string& context) {
  if (!choice) return {.start = compiled.home_key()};
  if (const int* number = std::get_if<int>(&*choice))
    return {.start = KeyOfNumber(compiled, *number, context)};
  if (const auto* name = std::get_if<std::string>(&*choice))
    return {.start = RequireId(compiled.model(), mjOBJ_KEY, *name, context)};
  return KeysOfParts(compiled, std::get<std::map<std::string, std::string>>(*choice), context);
}

void RestoreKeys(const mjModel* model, mjData* data, const StartKeys& keys,
                 const std::string& context) {
  Guarded(context, data, [&] {
    if (keys.start >= 0) {
      mj_resetDataKeyframe(model, data, keys.start);
    } else {
      mj_resetData(model, data);
    }
  });
  for (const int key : keys.over) {
    Overlay(model->key_qpos, keys.start, key, model->nq, data->qpos);
    Overlay(model->key_qvel, keys.start, key, model->nv, data->qvel);
    Overlay(model->key_act, keys.start, key, model->na, data->act);
    Overlay(model->key_ctrl, keys.start, key, model->nu, data->ctrl);
    Overlay(model->key_mpos, keys.start, key, 3 * model->nmocap, data->mocap_pos);
    Overlay(model->key_mquat, keys.start, key, 4 * model->nmocap, data->mocap_quat);
  }
}

}  // namespace robocell
