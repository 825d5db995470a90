// The kinds of tasks and scene sources for the fuzzers, which are built without the engine: the fields
// of the built-in kinds, without the rules of task/ and scenes/.
#include <memory>

#include "robocell/spec/scene_source_spec.h"
#include "robocell/spec/task_spec.h"
#include "robocell/task/pick_task_config.h"

namespace robocell {
namespace {

template <class T>
RegisteredKind FieldsAlone() {
  return {std::make_shared<KindFieldsOf<T>>(), std::make_shared<KindRules>()};
}

}  // namespace

KindRegistry& TaskKindRegistry() {
  static KindRegistry registry(
      "task", "kind", PickTaskConfig::kKind,
      {{PickTaskConfig::kKind, FieldsAlone<PickTaskConfig>()},
       {PickAndPlaceTaskConfig::kKind, FieldsAlone<PickAndPlaceTaskConfig>()}});
  return registry;
}

KindRegistry& SceneSourceRegistry() {
  static KindRegistry registry("scene source", "source", TabletopScenes::kKind,
                               {{TabletopScenes::kKind, FieldsAlone<TabletopScenes>()},
                                {FilesScenes::kKind, FieldsAlone<FilesScenes>()}});
  return registry;
}

}  // namespace robocell
