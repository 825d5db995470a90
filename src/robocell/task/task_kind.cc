#include "robocell/task/task_kind.h"

#include <fmt/format.h>

#include <map>
#include <mutex>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/task/pick_sampler.h"
#include "robocell/task/start_sampler.h"

namespace robocell {
namespace {

struct Registry {
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<const TaskKind>> kinds = {
      {PickTaskConfig::kKind, MakePickKind()},
      {PickAndPlaceTaskConfig::kKind, MakePickAndPlaceKind()}};
};

Registry& Kinds() {
  static Registry registry;
  return registry;
}

}  // namespace

std::shared_ptr<TaskSampler> TaskKind::MakeSampler(const RunConfig& run) const {
  return std::make_shared<TaskStartSampler>(run);
}

std::vector<SceneObject> TaskKind::Contents(const RunConfig& run) const {
  SceneSpec spec;
  Rng rng = Rng::Stream(static_cast<uint64_t>(run.seed), "task contents");
  const auto known = [&] {
    const int scene = SceneIndices(run).front();
    return std::make_shared<const SceneAnnotations>(MakeSceneSource(run)->Annotations(scene));
  };
  Make(run.task)->PrepareIn(known, spec, rng);
  std::vector<SceneObject> objects;
  for (const SceneObject& object : spec.objects) objects.push_back(object);
  return objects;
}

void RegisterTask(const std::string& kind, std::shared_ptr<const KindFields> fields,
                  std::shared_ptr<const TaskKind> task, bool replace) {
  if (!task) throw ArgumentError("task '" + kind + "' needs a TaskKind that makes it");
  RegisterTaskFields(kind, std::move(fields), replace);
  Registry& registry = Kinds();
  const std::lock_guard lock(registry.mutex);
  registry.kinds[kind] = std::move(task);
}

std::shared_ptr<const TaskKind> FindTaskKind(const std::string& kind) {
  Registry& registry = Kinds();
  const std::lock_guard lock(registry.mutex);
  const auto found = registry.kinds.find(kind);
  if (found != registry.kinds.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [name, task] : registry.kinds) known.push_back(name);
  throw NotFoundError(NoSuchName("", "task", kind, known));
}

std::shared_ptr<Task> MakeTask(const EnvConfig& config, const Scene& scene) {
  if (!config.task) return nullptr;
  std::shared_ptr<Task> task = FindTaskKind(config.task->kind())->Make(*config.task);
  TaskSetting setting{.place = "environment '" + config.name + "'", .robots = config.robots.keys()};
  for (const auto& [id, object] : config.root_frame_objects.entries())
    setting.objects.emplace(id, object->offset);
  task->Bind(scene, setting);
  return task;
}

void PrepareTask(const EnvConfig& config, SceneSpec& spec) {
  if (!config.task) return;
  Rng rng = Rng::Stream(0, "env task contents", config.task->kind());
  const SceneSpec& so_far = spec;
  const auto known = [&] {
    return std::make_shared<const SceneAnnotations>(DeriveAnnotations(so_far));
  };
  FindTaskKind(config.task->kind())->Make(*config.task)->PrepareIn(known, spec, rng);
}

}  // namespace robocell
