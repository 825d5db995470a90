#include "robocell/spec/pick_task_config.h"

#include "robocell/spec/validate.h"

namespace robocell {

void PickTaskConfig::Validate(Problems& problems) const {
  CheckRange(base_distance, "base_distance", problems);
  CheckRange(base_height_noise, "base_height_noise", problems);
}

}  // namespace robocell
