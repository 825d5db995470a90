#include "robocell/env/pick_env_task.h"

#include <algorithm>

namespace robocell {

double PickEnvTask::Progress() const {
  const double lifted = std::clamp(Lift() / task().lift_height, 0.0, 1.0);
  return 0.5 * Nearness() + 0.5 * lifted;
}

}  // namespace robocell
