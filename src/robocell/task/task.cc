#include "robocell/task/task.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"
#include "robocell/scenes/catalogue.h"

namespace robocell {

namespace {

std::vector<std::string> NamesOf(const SceneSpec& spec) {
  std::vector<std::string> names;
  for (const SceneObject& object : spec.objects) names.push_back(object.name);
  return names;
}

// Returns what is wrong with the objects of which `present` were there before, and the next step; ""
// if nothing is.
std::string WhyUnsound(const SceneSpec& spec, const std::vector<std::string>& present) {
  const size_t before = present.size();
  for (size_t i = 0; i < before; ++i) {
    if (i < spec.objects.size() && spec.objects[i].name == present[i]) continue;
    return fmt::format(
        "moved or removed object '{}' of scene '{}'; leave those that are there where they are, "
        "and "
        "append others",
        present[i], spec.name);
  }
  std::map<std::string, size_t> numbers;
  for (size_t i = 0; i < spec.objects.size(); ++i) {
    const SceneObject& object = spec.objects[i];
    const auto [other, is_new] = numbers.emplace(object.name, i);
    if (i < before) continue;
    if (!is_new && other->second < before) {
      return fmt::format(
          "added object '{}', a name that scene '{}' has already (objects[{}]); "
          "give it another one",
          object.name, spec.name, other->second);
    }
    if (!is_new) {
      return fmt::format(
          "added object '{}' twice to scene '{}' (objects[{}] and objects[{}]); "
          "append each object once, and give each a name of its own",
          object.name, spec.name, other->second, i);
    }
    if (object.fixed == true && !object.has_pose() && object.attach_to == AttachTarget{}) {
      return fmt::format(
          "added object '{}' to scene '{}' as fixed and without `pos`, and only objects that move "
          "are put on a support; give it a `pos`, [0, 0, 0] for the origin, or leave `fixed` out",
          object.name, spec.name);
    }
    if (!object.shape || !object.size) continue;  // models are measured later
    if (const std::string why = WhyTooLarge(object, ObjectSizes().Of(object)); !why.empty())
      return "added an object to scene '" + spec.name + "' that cannot be handled: " + why;
  }
  return "";
}

}  // namespace

const SceneAnnotations& Task::annotations() const {
  if (!annotations_) {
    if (!known_scene_)
      throw Error(
          "read the annotations of a scene in prepare() first, and keep there what is needed "
          "later");
    annotations_ = (*known_scene_)();
  }
  return *annotations_;
}

void Task::PrepareIn(const KnownScene& known, SceneSpec& spec, Rng& rng, const std::string& kind,
                     const StartTurn& turn) {
  struct Preparing {
    Task& task;
    ~Preparing() { task.known_scene_ = nullptr; }
  } const preparing{*this};
  annotations_.reset();
  turn_ = turn;
  known_scene_ = &known;
  const std::optional<double> timestep = spec.timestep;
  const std::vector<std::string> before = NamesOf(spec);
  Prepare(spec, rng);
  const std::string who = kind.empty() ? "" : "task '" + kind + "': ";
  if (const std::string why = WhyUnsound(spec, before); !why.empty())
    throw HookError(who + "prepare() " + why, PlaceOfHook("prepare"));
  if (spec.timestep == timestep) return;
  const auto seconds = [](const std::optional<double>& value) {
    return value ? fmt::format("{} s", *value) : std::string("unset");
  };
  throw HookError(
      fmt::format("prepare() changed the timestep of scene '{}' from {} to {}; leave it: `rates` "
                  "of a run (sim_ms) and `sim.timestep` of an environment set it, and rows are "
                  "timed by them",
                  spec.name, seconds(timestep), seconds(spec.timestep)),
      PlaceOfHook("prepare"));
}

BaseRange SoundBaseRange(const Task& task) {
  return internal::CallHook(task, "base_range", [&] {
    const BaseRange range = task.base_range();
    RequireSound(range);
    return range;
  });
}

}  // namespace robocell
