#include "robocell/task/task.h"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"

namespace robocell {

const SceneAnnotations& Task::annotations() const {
  if (!annotations_) {
    if (!known_scene_)
      throw Error(
          "annotations of a scene are asked for in prepare() first; keep there what is needed "
          "later");
    annotations_ = (*known_scene_)();
  }
  return *annotations_;
}

void Task::PrepareIn(const KnownScene& known, SceneSpec& spec, Rng& rng) {
  struct Preparing {
    Task& task;
    ~Preparing() { task.known_scene_ = nullptr; }
  } const preparing{*this};
  annotations_.reset();
  known_scene_ = &known;
  const std::optional<double> timestep = spec.timestep;
  Prepare(spec, rng);
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
