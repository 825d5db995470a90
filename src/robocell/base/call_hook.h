// Calls hooks (hook_error.h), and what checks their results, so that what is wrong names the hook.
//
//   const TaskVerdict verdict = CallHook(*task, "judge", [&] { return task->Judge(scene); });
#pragma once

#include <type_traits>

#include "robocell/base/hook_error.h"

namespace robocell::internal {

// Throws the exception that is being handled as a HookError, as far as it says that a hook failed.
// It stays as it is for a full disk and a wrong spec, which would fail again, for errors of the
// engine, for closed scenes and divergence, and for exceptions of other languages, which say more.
[[noreturn]] void RethrowOfHook(const Hooks& hooks, const char* method);

// Calls a hook, or what checks its result. Exceptions of the standard library and of robocell
// become a HookError with the place of the method.
template <class Call>
std::invoke_result_t<Call> CallHook(const Hooks& hooks, const char* method, Call&& call) {
  try {
    return call();
  } catch (...) {
    RethrowOfHook(hooks, method);
  }
}

}  // namespace robocell::internal
