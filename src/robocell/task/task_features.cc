#include "robocell/task/task_features.h"

#include <utility>

#include "robocell/base/call_hook.h"
#include "robocell/features/declared_features.h"

namespace robocell {

CellFeatures FeaturesOfCell(const Scene& scene, const std::vector<Robot>& robots,
                            std::shared_ptr<const Task> task, const std::vector<std::string>& own) {
  CellFeatureOptions options{.own = own};
  if (task) {
    options.objects = internal::CallHook(*task, "objects", [&] {
      std::vector<std::string> names = task->objects();
      for (const std::string& name : names) scene.compiled()->object(name);  // NotFoundError
      return names;
    });
    options.more = std::make_unique<DeclaredFeatures>(scene, std::move(task), "task");
  }
  return {scene, robots, std::move(options)};
}

}  // namespace robocell
