#include "robocell/spec/run_config.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "robocell/spec/timestep.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

// How often `part` fits into `whole`; 0 when it does not fit a whole number of times.
int Multiple(double whole, double part) {
  if (!(part > 0) || !(whole > 0)) return 0;
  const double ratio = whole / part;
  const double rounded = std::round(ratio);
  return rounded >= 1 && rounded < 1e9 && std::abs(ratio - rounded) < 1e-9 * rounded
             ? static_cast<int>(rounded)
             : 0;
}

void CheckMultiple(const char* field, double whole, const char* of, double part,
                   Problems& problems) {
  if (whole > 0 && part > 0 && Multiple(whole, part) == 0) {
    const double below = std::max(1.0, std::floor(whole / part)) * part;
    problems.AddAt(
        field,
        fmt::format("{} ms is not a multiple of {} ({} ms); the nearest are {:.6g} and {:.6g} ms{}",
                    whole, of, part, below, below + part,
                    whole < 1 && whole < part
                        ? fmt::format(". Are these seconds? Then write {:.6g}", 1000 * whole)
                        : ""));
  }
}

// More than these and one action takes longer than anybody waits.
constexpr double kMostStepsPerAction = 1e6;

void CheckStepsPerAction(const Rates& rates, Problems& problems) {
  const double steps = rates.policy_ms / rates.sim_ms;
  if (!(rates.sim_ms > 0) || steps <= kMostStepsPerAction) return;
  problems.AddAt("policy_ms",
                 fmt::format("{:g} ms are {:.0f} steps of the engine of {:g} ms for every action, "
                             "at most {:.0f}; 66 ms is usual",
                             rates.policy_ms, steps, rates.sim_ms, kMostStepsPerAction));
}

}  // namespace

void TaskConfig::Validate(Problems& problems) const {
  CheckRange(base_distance, "base_distance", problems);
  CheckRange(base_height_noise, "base_height_noise", problems);
}

SceneSourceKind SceneSource::kind() const {
  return source.value_or(files.empty() ? SceneSourceKind::kTabletop : SceneSourceKind::kFiles);
}

size_t SceneSource::count() const {
  if (!houses.empty()) return houses.size();
  return kind() == SceneSourceKind::kFiles ? files.size() : 1;
}

void SceneSource::Validate(Problems& problems) const {
  const bool from_files = kind() == SceneSourceKind::kFiles;
  if (from_files && files.empty()) {
    problems.AddAt("files", "`source: files` needs at least one MJCF file");
  }
  if (!from_files && !files.empty()) {
    problems.AddAt("files",
                   std::string("go with `source: files`; this source is ") + ToString(kind()));
  }
  std::set<int> seen;
  for (const int house : houses.values) {
    if (house < 0) problems.AddAt("houses", fmt::format("{} is negative", house));
    if (from_files && house >= static_cast<int>(files.size())) {
      problems.AddAt("houses", fmt::format("{} is outside the {} files (they count from 0)", house,
                                           files.size()));
    }
    if (!seen.insert(house).second) {
      problems.AddAt("houses", fmt::format("{} is listed twice", house));
    }
  }
}

int Rates::control_ticks() const { return Multiple(policy_ms, control_ms); }
int Rates::sim_steps() const { return Multiple(control_ms, sim_ms); }

void Rates::Validate(Problems& problems) const {
  CheckTimestep(sim_ms, 1000, "sim_ms", problems);
  if (sim_ms >= kShortestTimestep * 1000) CheckStepsPerAction(*this, problems);
  CheckMultiple("policy_ms", policy_ms, "control_ms", control_ms, problems);
  CheckMultiple("control_ms", control_ms, "sim_ms", sim_ms, problems);
}

void RunConfig::Validate(Problems& problems) const {
  CheckNotEmpty(run, "run", "the run's name", problems);
  CheckNotEmpty(output, "output", "the folder the dataset goes to", problems);
  if (robot.config == RobotConfig{}) {
    problems.AddAt("robot", "is required: a robot file, or the robot's fields");
  } else {
    Problems::Scope scope(problems, "robot");
    ValidateFields(robot.config, problems);
  }
}

}  // namespace robocell
