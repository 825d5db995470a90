#include "robocell/task/task_calls.h"

#include <fmt/format.h>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"
#include "robocell/scenes/object_places.h"

namespace robocell::internal {

void TaskCalls::Prepare(const Task::KnownScene& known, SceneSpec& spec, Rng& rng,
                        const std::string& kind, const StartTurn& turn) {
  CallHook(task_, "prepare", [&] { task_.PrepareIn(known, spec, rng, kind, turn); });
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
    for (const std::string& name : task_.objects()) compiled.object(name);  // NotFoundError
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

bool TaskCalls::HoldsElsewhere(std::span<const double> memory) {
  return CallHook(task_, "memory", [&] { return task_.HoldsElsewhere(memory); });
}

}  // namespace robocell::internal
