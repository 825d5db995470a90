// ExpertCalls: calls the hooks of an expert during a rollout, so that an error of a hook is a HookError
// that names the hook and its place (task/task_calls.h does the same for tasks). If errors are to fail
// the rollout, as in evaluations, the first one is kept as the reason, and no hook is called any more.
//
//   ExpertCalls calls(expert, options.expert_errors_fail);
//   calls.Do("begin", [&] { expert.Begin(scene, rng); });
//   const bool done = calls("done", true, [&] { return expert.done(); });
//
// The expert has to outlive it.
#pragma once

#include <functional>
#include <string>

#include "robocell/base/call_hook.h"
#include "robocell/base/hook_error.h"
#include "robocell/expert/expert.h"

namespace robocell::internal {

// Returns the reason of a rollout that an error of its policy or expert ended.
std::string PolicyError(const HookError& error);

class ExpertCalls {
 public:
  ExpertCalls(Expert& expert, bool errors_fail) : expert_(expert), errors_fail_(errors_fail) {}

  // Returns `otherwise` after an error.
  template <class Result, class Call>
  Result operator()(const char* method, Result otherwise, Call&& call) {
    if (!error_.empty()) return otherwise;
    try {
      return CallHook(expert_, method, call);
    } catch (const HookError& error) {
      if (!errors_fail_) throw;
      Keep(error);
      return otherwise;
    }
  }
  void Do(const char* method, const std::function<void()>& call) {
    (*this)(method, false, [&] { return call(), true; });
  }
  // Returns the error, else why the expert gave up.
  std::string failure();
  bool failed() const { return !error_.empty(); }

 private:
  void Keep(const HookError& error);

  Expert& expert_;
  bool errors_fail_;
  std::string error_;
};

}  // namespace robocell::internal
