#include "robocell/spec/run_config.h"

#include <fmt/format.h>

#include <optional>

#include "robocell/base/error.h"
#include "robocell/spec/pinned_values.h"
#include "robocell/spec/validate.h"

namespace robocell {

namespace {

// An action takes effect before the next one comes.
void ValidateDelay(const RunConfig& run, Problems& problems) {
  if (!run.randomize) return;
  const std::optional<double> most = internal::LongestDelay(*run.randomize);
  if (!most) return;
  double period = 0;
  try {
    period = run.rates.policy_period();
  } catch (const ArgumentError&) {
    return;  // reported at `rates`
  }
  if (*most <= period + 1e-9) return;
  problems.AddAt(run.randomize->pinned.contains("action_delay") ? "randomize.pinned.action_delay"
                                                                : "randomize.action_delay",
                 fmt::format("can be {:g} s, and an action comes every {:g} s: the delay is at "
                             "most that",
                             *most, period));
}

}  // namespace

void RunConfig::Validate(Problems& problems) const {
  ValidateDelay(*this, problems);
  task.rules()->ValidateRun(*this, problems);
  ValidateNotEmpty(run, "run", "the run's name", problems);
  ValidateNotEmpty(output, "output", "the folder the dataset goes to", problems);
  if (augment && !expert.empty())
    problems.AddAt("augment", "replaces the expert: leave out `expert`, or `augment`");
  if (robot.config == RobotConfig{}) {
    problems.AddAt("robot", "is required: a robot file, or the robot's fields");
  } else {
    Problems::Scope scope(problems, "robot");
    ValidateFields(robot.config, problems);
  }
}

}  // namespace robocell
