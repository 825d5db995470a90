#include "robocell/spec/task_spec.h"

#include "robocell/spec/pick_task_config.h"

namespace robocell {

KindRegistry& TaskKindRegistry() {
  static KindRegistry registry(
      "task", "kind",
      {{PickTaskConfig::kKind, std::make_shared<KindFieldsOf<PickTaskConfig>>()},
       {PickAndPlaceTaskConfig::kKind, std::make_shared<KindFieldsOf<PickAndPlaceTaskConfig>>()}});
  return registry;
}

}  // namespace robocell
