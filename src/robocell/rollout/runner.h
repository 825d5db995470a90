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
// success is reported as such, and with `keep: all`, where every attempt is a separate episode
// ("s0003_e0001_a02"), only the missing ones are made. The dataset must have been prepared for the
// run (prepare.h), and must not be repaired meanwhile (dataset_lock.h). Throws SpecError before
// anything runs, and IoError when the disk fails (nothing half-written stays). A stop request ends
// Run at the next policy tick without a commit.
//
// A HookError of a user's code ends its attempt like a failure of that name; the third one in a row
// is rethrown to the caller of Run. With Keep::kFirst, in evaluations, one of the expert is the
// failure of its rollout, which is kept, and any other one of an accepted start is thrown at once,
// because no other start may take its place. Errors of the engine and of built-in code are always
// rethrown.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "robocell/base/stop.h"
#include "robocell/expert/expert.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/prepare.h"
#include "robocell/task/task_sampler.h"

namespace robocell {

struct ItemResult {
  PlanItem item;
  bool committed = false;  // there is an episode on the disk
  bool complete = false;   // nothing is left to do for the item
  bool success = false;
  bool stopped = false;                 // true if the stop request ended it
  bool resumed = false;                 // it was complete before
  int kept = 0;                         // episodes written now
  int attempts = 0;                     // finished attempts, including those kept earlier
  int accepted = 0;                     // attempts whose start the sampler accepted (= rollouts)
  int undecided = 0;                    // attempts that the stop request ended
  std::map<std::string, int> refusals;  // 'stage: reason' -> count, of starts
  int out_of_reach = 0;                 // those of them from where the robot does not reach
  // The most frequent reason of refused starts and the last of them; if no start was accepted for
  // lack of reach, also from where the robot would reach. "" otherwise.
  std::string advice;
  std::map<std::string, int> redrawn;   // reason -> count, of places tried within the attempts
  std::map<std::string, int> failures;  // reason -> count, of rollouts
  std::string failure;                  // why the last rollout failed; "" if it succeeded
  std::string robot;                    // its name
  std::string object_kind;              // object kind of the last attempt's target; "" if unknown
  std::map<std::string, int> kinds;     // object kind -> attempts
  std::map<std::string, int> rollouts;  // object kind -> rollouts
  int rows = 0;  // of the committed episode, or of the last rollout of a runner that stores none
  double seconds_sampling = 0, seconds_acting = 0, seconds_rendering = 0, seconds_writing = 0;
};

// Factories of replaceable parts; both get the validated configuration. No name of the run stands
// for them, so a dataset that they made records that they were unregistered: a Runner with other
// parts does not go on with it, and one with an unregistered sampler has no RunOfDataset.
struct RunnerParts {
  std::function<std::shared_ptr<TaskSampler>(const RunConfig&)> sampler = {};
  std::function<std::shared_ptr<Expert>(const RunConfig&, const EpisodeStart&)> expert = {};
  // Makes the data of the starts' scenes (SampleRequest::scene_data).
  DataFactory scene_data = {};
  // False: results are returned and nothing is written. Every item is made, also one whose episode
  // is there.
  bool stores = true;
};

class Runner {
 public:
  explicit Runner(RunConfig run, RunnerParts parts = {});
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  const RunConfig& run() const;
  ItemResult Run(const PlanItem& item, const StopRequest& stop = {});

  // For an owner that keeps the sampler as an object of another language: gives access to the only
  // reference from here, and drops it. After that Run is an Error.
  const std::shared_ptr<TaskSampler>& sampler() const;
  void DropSampler();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell
