// Calls hooks (hook_error.h), and what checks their results, so that what is wrong names the hook.
//
//   const TaskVerdict verdict = CallHook(*task, "judge", [&] { return task->Judge(scene); });
#pragma once

#include <type_traits>

#include "robocell/base/hook_error.h"

namespace robocell::internal {

// Throws the exception that is being handled as a HookError, as far as it says that a hook failed:
// not for a disk that is full or a spec that is wrong, which would fail again, nor for exceptions of
// other languages, which tell more as they are.
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
