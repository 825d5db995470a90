#include "robocell/spec/pick_task_config.h"

#include "robocell/spec/task_spec.h"
#include "robocell/spec/validate.h"

namespace robocell {

namespace {

template <class T>
PickRun RunOf(const T& task) {
  return {.objects = task.objects,
          .lift_height = task.lift_height,
          .base_distance = task.base_distance,
          .base_height_offset = task.base_height_offset,
          .base_height_noise = task.base_height_noise};
}

template <class T>
void ValidateRanges(const T& task, Problems& problems) {
  ValidateRange(task.base_distance, "base_distance", problems);
  ValidateRange(task.base_height_noise, "base_height_noise", problems);
}

}  // namespace

void PickTaskConfig::Validate(Problems& problems) const { ValidateRanges(*this, problems); }
void PickAndPlaceTaskConfig::Validate(Problems& problems) const { ValidateRanges(*this, problems); }

std::optional<PickRun> PickRunOf(const TaskSpec& task) {
  if (const auto* pick = task.If<PickTaskConfig>()) return RunOf(*pick);
  if (const auto* place = task.If<PickAndPlaceTaskConfig>()) return RunOf(*place);
  return std::nullopt;
}

}  // namespace robocell
