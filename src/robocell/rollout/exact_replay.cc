#include "robocell/rollout/exact_replay.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <utility>

#include "robocell/task/task_judge.h"

namespace robocell::internal {

ExactReplay::ExactReplay(Scene scene, Task& task, StepperRates rates)
    : scene_(std::move(scene)), task_(task), rates_(rates), state_(scene_.state()) {}

std::string ExactReplay::Judge() {
  scene_.SetState(state_);
  TaskJudge judge(task_, scene_);
  judge.Begin();
  const auto nu = static_cast<size_t>(scene_.model()->nu);
  const size_t ticks = nu == 0 ? 0 : ctrl_.size() / nu;
  bool success = false;
  for (size_t tick = 0; tick < ticks; ++tick) {
    std::copy_n(ctrl_.begin() + static_cast<std::ptrdiff_t>(tick * nu), nu, scene_.data()->ctrl);
    if (!scene_.StepN(rates_.sim_steps).ok()) return "diverged on exact replay";
    if ((tick + 1) % static_cast<size_t>(rates_.control_ticks) != 0) continue;
    scene_.SyncPoses();
    success = judge.Judge().success;
  }
  return success ? "" : "no success on exact replay";
}

}  // namespace robocell::internal
