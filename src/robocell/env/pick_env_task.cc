#include "robocell/env/pick_env_task.h"

#include <algorithm>

namespace robocell {

double PickEnvTask::Reward(const Scene& scene) {
  if (Success(scene)) return 1;
  const double lifted = std::clamp(Lift(scene) / task().lift_height, 0.0, 1.0);
  return 0.5 * Nearness(scene) + 0.5 * lifted;
}

}  // namespace robocell
