// Are the files of a run's models still what they were when the run was compared with its dataset?
// Whoever compiles them afterwards asks, so that editing a robot while a run goes on makes no
// dataset of two robots.
//
//   const RunFilesWatch watch(RequireSameRun(run));
//   ... sample, compile, act ...
//   watch.RequireUnchanged(run);   // before anything is kept
//
// Asking costs a look at each file (microseconds); what they hold is read again only when the
// system says that they are other files.
#pragma once

#include "robocell/rollout/run_inputs.h"

namespace robocell {

class RunFilesWatch {
 public:
  RunFilesWatch() = default;
  explicit RunFilesWatch(RunInputs inputs) : inputs_(std::move(inputs)) {}
  // IoError that names the files that are others now, or gone, and what to do.
  void RequireUnchanged(const RunConfig& run) const;

 private:
  RunInputs inputs_;
};

}  // namespace robocell
