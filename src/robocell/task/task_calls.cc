#include "robocell/task/task_calls.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/object_places.h"

namespace robocell::internal {
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

void TaskCalls::Prepare(const Task::KnownScene& known, SceneSpec& spec, Rng& rng,
                        const std::string& kind, const std::optional<StartTurn>& turn) {
  struct Preparing {
    Task& task;
    ~Preparing() { task.known_scene_ = nullptr; }
  } const preparing{task_};
  task_.annotations_.reset();
  task_.turn_ = turn.value_or(StartTurn());
  task_.is_prepared_once_ = !turn;
  task_.known_scene_ = &known;
  const std::optional<double> timestep = spec.timestep;
  const std::vector<std::string> before = NamesOf(spec);
  const std::string why = CallHook(task_, "prepare", [&] {
    task_.Prepare(spec, rng);
    return WhyUnsound(spec, before);
  });
  const std::string who = kind.empty() ? "" : "task '" + kind + "': ";
  if (!why.empty()) throw HookError(who + "prepare() " + why, task_.PlaceOfHook("prepare"));
  if (spec.timestep == timestep) return;
  const auto seconds = [](const std::optional<double>& value) {
    return value ? fmt::format("{} s", *value) : std::string("unset");
  };
  throw HookError(
      fmt::format("prepare() changed the timestep of scene '{}' from {} to {}; leave it: `rates` "
                  "of a run (sim_ms) and `sim.timestep` of an environment set it, and rows are "
                  "timed by them",
                  spec.name, seconds(timestep), seconds(spec.timestep)),
      task_.PlaceOfHook("prepare"));
}

void TaskCalls::Bind(const Scene& scene, const TaskSetting& setting) {
  CallHook(task_, "bind", [&] { task_.Bind(scene, setting); });
}

BodyPoses TaskCalls::Starts(Rng& rng) {
  return CallHook(task_, "starts", [&] { return task_.Starts(rng); });
}

void TaskCalls::RequireObjects(const Scene& scene, std::span<const SceneObject> prepared) {
  const CompiledScene& compiled = *scene.compiled();
  CallHook(task_, "prepare", [&] {
    for (const SceneObject& object : prepared) {
      if (KeepsPose(object) || object.parked || compiled.object(object.name).free_joint) continue;
      throw ArgumentError(fmt::format(
          "object '{}' has no `pos`, and no place can be drawn for it: its model has joints of its "
          "own and none that lets it move freely. Give it a `pos`, or `fixed: false`",
          object.name));
    }
  });
  CallHook(task_, "objects", [&] {
    for (const std::string& name : task_.objects()) compiled.object(task_.object_of(name));
  });
}

void TaskCalls::Put(Scene& scene, const BodyPoses& starts) {
  CallHook(task_, "starts", [&] {
    for (const auto& [body, pose] : starts) scene.SetBodyPose(body, pose);
  });
}

// Only after an error the bodies are moved one by one, to find out whether it is about one of them.
void TaskCalls::Reset(Scene& scene, const ResetOptions& options) {
  try {
    scene.Reset(options);
  } catch (const Error&) {
    Put(scene, options.body_poses);
    throw;
  }
}

std::optional<Refusal> TaskCalls::Arrange(Scene& scene, Rng& rng) {
  return CallHook(task_, "arrange", [&] { return task_.Arrange(scene, rng); });
}

std::optional<Refusal> TaskCalls::CheckStart(const Scene& scene) {
  return CallHook(task_, "check_start", [&] { return task_.CheckStart(scene); });
}

std::vector<std::string> TaskCalls::RestingObjects(const Scene& scene) {
  return CallHook(task_, "resting_objects", [&] {
    std::vector<std::string> names = task_.resting_objects();
    for (const std::string& name : names) scene.compiled()->object(name);  // NotFoundError
    return names;
  });
}

Map<ObjectPlace> TaskCalls::Places() {
  return CallHook(task_, "places", [&] { return task_.places(); });
}

std::vector<std::string> TaskCalls::Objects() {
  return CallHook(task_, "objects", [&] { return task_.objects(); });
}

std::string TaskCalls::ObjectOf(const std::string& name) {
  return CallHook(task_, "object_of", [&] { return task_.object_of(name); });
}

std::string TaskCalls::KindOf(const std::string& object) {
  return CallHook(task_, "kind_of", [&] { return task_.kind_of(object); });
}

std::string TaskCalls::Instruction() {
  return CallHook(task_, "instruction", [&] { return task_.instruction(); });
}

std::string TaskCalls::WhyNotDone() {
  return CallHook(task_, "why_not_done", [&] { return task_.why_not_done(); });
}

std::vector<std::string> TaskCalls::Subtasks() {
  return CallHook(task_, "subtasks", [&] { return task_.subtasks(); });
}

std::vector<double> TaskCalls::Memory() {
  return CallHook(task_, "memory", [&] { return task_.memory(); });
}

void TaskCalls::Recall(std::span<const double> memory) {
  CallHook(task_, "recall", [&] { task_.Recall(memory); });
}

bool TaskCalls::CanRecall(std::span<const double> memory) {
  return CallHook(task_, "memory", [&] { return task_.CanRecall(memory); });
}

std::string TaskCalls::WhyNotRecalled(std::span<const double> memory) {
  return CallHook(task_, "memory", [&] { return task_.WhyNotRecalled(memory); });
}

bool TaskCalls::HoldsElsewhere(std::span<const double> memory) {
  return CallHook(task_, "memory", [&] { return task_.HoldsElsewhere(memory); });
}

}  // namespace robocell::internal
