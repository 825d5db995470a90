// Hooks: methods of tasks, experts and samplers, and functions of features, which users may write.
// HookError: one of them failed, or returned what cannot be used. Runs end the attempt with it,
// whoever noticed.
//
//   const TaskVerdict verdict =
//       internal::CallHook(*task, "judge", [&] { return task->Judge(scene); });
#pragma once

#include <stdexcept>
#include <string>
#include <type_traits>

#include "robocell/base/error.h"

namespace robocell {

class HookError : public ArgumentError {
 public:
  // In Python: TypeError, ArgumentError, Error.
  enum class Kind { kType, kValue, kFailed };
  // `place`: where the hook is written, "my_task.py:12, in judge"; it ends the message. "" when it
  // is not known yet, or for compiled code.
  HookError(const std::string& message, const std::string& place, Kind kind = Kind::kValue)
      : ArgumentError(place.empty() ? message : message + " (" + place + ")"),
        has_place_(!place.empty()),
        kind_(kind) {}
  bool has_place() const { return has_place_; }
  Kind kind() const { return kind_; }

 private:
  bool has_place_;
  Kind kind_;
};

// What has hooks.
class Hooks {
 public:
  virtual ~Hooks() = default;
  // Where a method is written, as HookError has it; "" for compiled code.
  virtual std::string PlaceOfHook(const char* /*method*/) const { return ""; }
};

namespace internal {

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

}  // namespace internal
}  // namespace robocell
