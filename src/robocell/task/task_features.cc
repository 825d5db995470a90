#include "robocell/task/task_features.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>
#include <utility>

#include "robocell/base/call_hook.h"
#include "robocell/features/declared_features.h"

namespace robocell {

namespace {

std::string ObjectOf(const Task& task, const Scene& scene, const std::string& name) {
  return internal::CallHook(task, "object_of", [&] {
    return scene.compiled()->object(task.object_of(name)).name;  // NotFoundError
  });
}

}  // namespace

ObjectOfName ObjectOfNameIn(std::shared_ptr<const Task> task) {
  if (!task) return {};
  return [task = std::move(task)](const Scene& scene, const std::string& name) {
    return ObjectOf(*task, scene, name);
  };
}

std::vector<std::string> ObjectsOf(const Task& task, const Scene& scene) {
  return internal::CallHook(task, "objects", [&] {
    std::vector<std::string> names = task.objects();
    std::set<std::string> known;
    for (const std::string& name : names) {
      scene.compiled()->object(task.object_of(name));  // NotFoundError
      if (known.insert(name).second) continue;
      throw ArgumentError(fmt::format(
          "the task's objects() names '{}' twice: {}; name each object once, the target first",
          name, fmt::join(names, ", ")));
    }
    return names;
  });
}

CellFeatures FeaturesOfCell(const Scene& scene, const std::vector<Robot>& robots,
                            std::shared_ptr<const Task> task, const std::vector<std::string>& own) {
  CellFeatureOptions options{.own = own};
  if (task) {
    options.objects = ObjectsOf(*task, scene);
    options.object_of = ObjectOfNameIn(task);
    options.more = std::make_unique<DeclaredFeatures>(scene, std::move(task), "task");
  }
  return {scene, robots, std::move(options)};
}

}  // namespace robocell
