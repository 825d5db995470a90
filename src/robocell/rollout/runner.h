// Runner: makes the episodes of a plan, one after the other, in this process. For each item it
// makes attempts until one succeeds: sample a start, let the expert act through the Stepper,
// record, judge, commit or drop.
//
//   RunConfig run = RunConfig::Load("xarm7_pick.yaml");
//   PrepareDataset(run);
//   Runner runner(run);
//   ItemResult result = runner.Run(MakePlan(run)[0]);
//   if (result.committed) ...
//
// All randomness comes from AttemptStream, so an episode does not depend on which process makes it,
// in what order, or what was made before. Existing episodes are not made again: an item with a
// success is reported as such, and with `keep: all`, where every attempt is an episode of its own
// ("s0003_e0001_a02"), only the missing ones are made. The dataset must have been prepared for the
// run (prepare.h), and must not be repaired meanwhile (dataset_lock.h). Throws SpecError before
// anything runs, and IoError when the disk fails (nothing half-written stays). A stop request ends
// Run at the next policy tick without a commit.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "robocell/base/stop.h"
#include "robocell/rollout/on_disk.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/prepare.h"
#include "robocell/task/task.h"

namespace robocell {

struct ItemResult {
  PlanItem item;
  bool committed = false;  // there is an episode on the disk
  bool complete = false;   // nothing is left to do for the item
  bool success = false;
  bool stopped = false;                 // by the stop request
  bool resumed = false;                 // it was complete before
  int kept = 0;                         // episodes written now
  int attempts = 0;                     // finished attempts, including those kept earlier
  int accepted = 0;                     // attempts whose start the sampler accepted (= rollouts)
  int undecided = 0;                    // attempts that the stop request ended
  std::map<std::string, int> refusals;  // 'stage: reason' -> count, of starts
  // The most frequent reason of refused starts and the last of them; if no start was accepted for
  // lack of reach, also from where the robot would reach. "" otherwise.
  std::string advice;
  std::map<std::string, int> redrawn;   // reason -> count, of places tried within the attempts
  std::map<std::string, int> failures;  // reason -> count, of rollouts
  std::string robot;                    // its name
  std::string object_kind;              // of the last attempt's target; "" if unknown
  std::map<std::string, int> kinds;     // object kind -> attempts
  std::map<std::string, int> rollouts;  // object kind -> rollouts
  int rows = 0;                         // of the committed episode
  double seconds_sampling = 0, seconds_acting = 0, seconds_rendering = 0, seconds_writing = 0;
};

// Factories of replaceable parts; both get the validated configuration.
struct RunnerParts {
  std::function<std::shared_ptr<TaskSampler>(const RunConfig&)> sampler = {};
  std::function<std::shared_ptr<Expert>(const RunConfig&, const EpisodeStart&)> expert = {};
  // Called while an exception is handled: returns a text for an exception that a user's own code
  // raised in another language, "" for all others. The exception ends the attempt like a failure of
  // that name, as a HookError of a user's code does; the third one in a row is rethrown to the
  // caller of Run. With Keep::kFirst a HookError of the expert is the failure of its rollout, which
  // is kept; other exceptions of an accepted start are rethrown at once, and so are errors of the
  // engine and of built-in code.
  std::function<std::string()> told_of_users = {};
};

class Runner {
 public:
  explicit Runner(RunConfig run, RunnerParts parts = {});
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  const RunConfig& run() const;
  ItemResult Run(const PlanItem& item, const StopRequest& stop = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell
