#include "robocell/env/env_task.h"

#include <fmt/format.h>

#include <map>
#include <mutex>

#include "robocell/base/both_languages.h"
#include "robocell/base/error.h"
#include "robocell/base/names.h"
#include "robocell/env/pick_env_task.h"
#include "robocell/env/pick_place_env_task.h"

namespace robocell {
namespace {

template <class T>
std::shared_ptr<EnvTask> MakeTask(const EnvConfig& config, const Scene& scene) {
  return std::make_shared<T>(config, scene);
}

struct TaskRegistry {
  std::mutex mutex;
  std::map<std::string, EnvTaskFactory> kinds = {{"pick", MakeTask<PickEnvTask>},
                                                 {"pick_place", MakeTask<PickPlaceEnvTask>}};
};

TaskRegistry& EnvTasks() {
  static TaskRegistry registry;
  return registry;
}

std::string PlaceOfTask(const EnvConfig& config) { return "environment '" + config.name + "'"; }

EnvTaskFactory FindTask(const EnvConfig& config) {
  TaskRegistry& registry = EnvTasks();
  {
    const std::lock_guard lock(registry.mutex);
    const auto found = registry.kinds.find(config.task->kind);
    if (found != registry.kinds.end()) return found->second;
  }
  throw NotFoundError(NoSuchName(PlaceOfTask(config), "task", config.task->kind, EnvTaskKinds()) +
                      " Tasks of your own are registered before with " +
                      InBothLanguages("RegisterEnvTask"));
}

}  // namespace

void RegisterEnvTask(const std::string& kind, EnvTaskFactory factory) {
  if (kind.empty()) throw ArgumentError("a task that is registered needs a name");
  if (!factory) throw ArgumentError("task '" + kind + "' needs a function that makes it");
  TaskRegistry& registry = EnvTasks();
  const std::lock_guard lock(registry.mutex);
  if (!registry.kinds.emplace(kind, std::move(factory)).second)
    throw ArgumentError("task '" + kind + "' is registered already; choose another name");
}

std::vector<std::string> EnvTaskKinds() {
  TaskRegistry& registry = EnvTasks();
  const std::lock_guard lock(registry.mutex);
  std::vector<std::string> kinds;
  for (const auto& [kind, factory] : registry.kinds) kinds.push_back(kind);
  return kinds;
}

std::shared_ptr<EnvTask> MakeEnvTask(const EnvConfig& config, const Scene& scene) {
  if (!config.task) return nullptr;
  std::shared_ptr<EnvTask> task = FindTask(config)(config, scene);
  if (task) return task;
  throw ArgumentError(fmt::format("{}: the function of task '{}' made none", PlaceOfTask(config),
                                  config.task->kind));
}

}  // namespace robocell
