// DrawStart: makes one attempt at the start of an item, for a Runner, which records the rollout, and
// for a RunEnv, whose caller acts. RefusedStarts counts the refusals of several attempts.
//
//   RefusedStarts refused;
//   for (int attempt = 0; attempt < run.max_attempts; ++attempt) {
//     SampleResult drawn = DrawStart({run, sampler}, item, attempt, stop);
//     if (ShouldStop(stop)) break;              // a refusal is arbitrary then
//     if (drawn.start) return BindStart(*drawn.start, run), std::move(*drawn.start);
//     refused.Add(drawn.refusal);
//   }
#pragma once

#include <string>

#include "robocell/base/stop.h"
#include "robocell/rollout/plan.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/refusal.h"
#include "robocell/task/task_sampler.h"

namespace robocell::internal {

// The run and the sampler that starts are drawn from.
struct StartDraw {
  const RunConfig& run;
  TaskSampler& sampler;
  const DataFactory& scene_data;  // SampleRequest::scene_data
  bool is_users = false;          // an error of the sampler is one of a user's hook
};

// Draws the start of an attempt at an item from the attempt's own stream, so that it does not depend
// on what was drawn before. The start is not bound yet (BindStart).
SampleResult DrawStart(const StartDraw& from, const PlanItem& item, int attempt,
                       const StopRequest& stop);

// Refused starts, counted as "stage: reason".
class RefusedStarts {
 public:
  void Add(const Refusal& refusal);

  const RefusalCounts& counts() const { return counts_; }
  int total() const { return total_; }
  // Returns the number of those from where the robot does not reach.
  int out_of_reach() const { return out_of_reach_; }
  // Returns the detail of the last refusal for the most frequent reason.
  const std::string& detail() const { return detail_; }
  // Returns ": settling: objects did not come to rest 2 times, ..."; "" without any.
  std::string Text() const;

 private:
  RefusalCounts counts_;
  int total_ = 0, out_of_reach_ = 0, most_ = 0;
  std::string detail_;
};

}  // namespace robocell::internal
