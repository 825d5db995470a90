#include "robocell/rollout/run_cell.h"

#include <cmath>
#include <memory>
#include <utility>

#include "robocell/features/declared_features.h"
#include "robocell/task/task_features.h"

namespace robocell::internal {
namespace {

// A cell whose task has begun: features may depend on it.
Cell BegunCell(const RunConfig& run, const EpisodeStart& start, std::string place) {
  Cell cell(start.scene, RobotsOf(start.scene), {run.rates.control_ticks(), run.rates.sim_steps()},
            start.task.get(), std::move(place));
  cell.Begin();
  return cell;
}

}  // namespace

RunCell::RunCell(const RunConfig& run, const EpisodeStart& start, Renderer* renderer,
                 std::string place)
    : cell(BegunCell(run, start, std::move(place))),
      features(FeaturesOfCell(start.scene, cell.robots(), Lent(start.task), run.features.names)),
      images(start.scene, run.cameras, renderer) {
  const RandomizedValue* delay = start.randomized.find("action_delay");
  if (delay && !delay->numbers.empty())
    cell.set_action_delay(std::llround(delay->numbers.front() / run.rates.control_period()));
}

}  // namespace robocell::internal
