// RunEnv: the cell of a run, to be acted in step by step from outside: the starts of its sampler, its
// rates, cameras and task. What it shows is what an episode of the run records, row by row, and
// actions are those that it records.
//
//   RunEnv env(run);
//   env.Reset(0);                                   // start number 0 of the run's seed
//   while (!done) {
//     const CellRow row = env.Row();                // what is recorded before an action
//     const RunStep step = env.Act({{"robots/rc7/action/arm", q}});
//     done = step.terminated || step.truncated;
//   }
//
// Start i is that of item i of the run's plan: generation, evaluation and this begin alike. Errors:
// those of a Runner; Error when Act comes before Reset or after the end of an episode. One thread at
// a time.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "robocell/base/stop.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task.h"

namespace robocell {

struct RunStep {
  double reward = 0, progress = 0;
  int subtask = 0;
  bool success = false;
  bool terminated = false;  // by success, or because the simulation diverged
  bool truncated = false;   // the run's max_steps are used up
  bool ik_failed = false;   // a pose had no solution: its group kept its target
  std::string reason;       // "success", "timeout", or how it diverged; "" while it goes on
};

class RunEnv {
 public:
  // SpecError for a run that is not right.
  explicit RunEnv(RunConfig run);
  ~RunEnv();
  RunEnv(RunEnv&&) noexcept;

  const RunConfig& run() const;
  // To start `index`: its first attempt from `first_attempt` on that is accepted. An episode names
  // the attempt that it is of, `attempt` of its metadata. Error with the reasons when none of
  // max_attempts is.
  void Reset(int index, int first_attempt = 0, const StopRequest& stop = {});
  // What is recorded of the present state; images are drawn by the first call in a state.
  CellRow Row();
  RunStep Act(const std::map<std::string, std::vector<double>>& actions);

  // Of the present episode.
  const FeatureSchema& observed() const;
  const FeatureSchema& commanded() const;
  const EpisodeStart& start() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell
