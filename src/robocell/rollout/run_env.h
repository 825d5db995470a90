// RunEnv: the cell of a run as an environment that the caller steps: the starts of its sampler, its
// rates, cameras and task. Its observations are what an episode of the run records, row by row, and
// its actions are those that an episode records.
//
//   RunEnv env(run);
//   env.Reset(0);                                   // start number 0 of the run's seed
//   while (!done) {
//     const CellRow row = env.Row();                // what is recorded before an action
//     const RunStep step = env.Act({{"robots/rc7/action/arm", q}});
//     done = step.terminated || step.truncated;
//   }
//
// Start i belongs to item i of the run's plan: generation, evaluation and RunEnv begin alike.
// Throws the errors of a Runner, and Error if Act comes before Reset or after the end of an
// episode. Use it from one thread at a time.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "robocell/base/stop.h"
#include "robocell/features/cell_row.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task.h"
#include "robocell/task/task_sampler.h"

namespace robocell {

// A step of a run, with the task's verdict on the state after it.
struct RunStep : TaskVerdict {
  bool terminated = false;  // true after success or divergence
  bool truncated = false;   // the run's max_steps are used up
  bool ik_failed = false;   // a pose had no solution: its group kept its target
  std::string reason;       // "success", "timeout", or the divergence; "" during the episode
};

class RunEnv {
 public:
  // `scene_data` makes the data of the starts' scenes (SampleRequest::scene_data). Throws SpecError
  // for an invalid run.
  explicit RunEnv(RunConfig run, DataFactory scene_data = {});
  ~RunEnv();
  RunEnv(RunEnv&&) noexcept;

  const RunConfig& run() const;
  // Resets to start `index`: the first accepted attempt from `first_attempt` on. An episode names
  // its attempt as `attempt` in its metadata. Throws Error with the reasons if max_attempts
  // attempts are refused.
  void Reset(int index, int first_attempt = 0, const StopRequest& stop = {});
  // Returns the recorded features of the present state; the first call in a state draws the images.
  CellRow Row();
  RunStep Act(const std::map<std::string, std::vector<double>>& actions);

  // Returns the schema of the present episode.
  const FeatureSchema& observed() const;
  const FeatureSchema& commanded() const;
  const EpisodeStart& start() const;
  // Returns the task of the present episode in words.
  std::string instruction() const;

  // Return and drop the only references to task and sampler (null without an episode), for owners
  // in another language. After that, every call is an Error.
  const std::shared_ptr<Task>& task() const;
  const std::shared_ptr<TaskSampler>& sampler() const;
  void Drop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell
