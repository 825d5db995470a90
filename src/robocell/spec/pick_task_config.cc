#include "robocell/spec/pick_task_config.h"

#include "robocell/spec/task_spec.h"

namespace robocell {

std::optional<PickRun> PickRunOf(const TaskSpec& task) {
  const auto run_of = [](const auto& pick) {
    return PickRun{.objects = pick.objects, .lift_height = pick.lift_height};
  };
  if (const auto* pick = task.If<PickTaskConfig>()) return run_of(*pick);
  if (const auto* place = task.If<PickAndPlaceTaskConfig>()) return run_of(*place);
  return std::nullopt;
}

}  // namespace robocell
