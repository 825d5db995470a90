// Calls hooks (hook_error.h), and checks of their results, so that errors name the hook.
//
//   const TaskVerdict verdict = CallHook(*task, "judge", [&] { return task->Judge(scene); });
#pragma once

#include <type_traits>

#include "robocell/base/hook_error.h"

namespace robocell::internal {

// Rethrows the exception being handled as a HookError if it means that a hook failed. Other
// exceptions pass through: a full disk and a wrong spec would fail again; errors of the engine,
// closed scenes and divergence contain more information. Hooks in another language throw HookErrors
// themselves.
[[noreturn]] void RethrowOfHook(const Hooks& hooks, const char* method);

// Calls a hook, or a check of its result. Exceptions of the standard library and of robocell become
// a HookError with the place of the method.
template <class Call>
std::invoke_result_t<Call> CallHook(const Hooks& hooks, const char* method, Call&& call) {
  try {
    return call();
  } catch (...) {
    RethrowOfHook(hooks, method);
  }
}

}  // namespace robocell::internal
