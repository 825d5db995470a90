// The one way to call an engine function that can fail: the engine's error becomes an EngineError
// with our context. (The engine's C++ part may also throw: Tried, in engine_exception.h.)
//
//   const int n = Guarded("scene 'pick': stepping", data,
//                         [&] { mj_step(model, data); return data->ncon; });
//
// The engine reports a fatal error by calling a handler that must not return. Ours jumps back to
// the innermost guard of the calling thread, over the engine's C frames. Therefore:
//  - `fn` calls engine functions only, holds nothing with a destructor and captures by
//    reference (checked where the compiler can); prepare strings and vectors
//    outside.
//  - An engine callback of ours that runs inside (mjcb_control ...) holds nothing across engine
//    calls either, unless it guards them itself: guards nest, and each error reaches the
//    innermost one.
// A C++ exception thrown by `fn` itself passes through unchanged.
//
// With an mjData given, the engine's stack in it is restored after an error; the rest of the data
// is in an undefined (but memory-safe) state: reset it or copy a good state into it before the next
// step.
//
// The guard's handler is thread-local and takes precedence over handlers that others install: those
// of the Python package `mujoco` (active only inside its own calls, so it matters when a Python
// callback called by the engine calls us), the engine's own inside mjb_apply, and any process-wide
// one. Outside of guards nothing changes for others, except that warnings and information go to
// base/log and that MUJOCO_LOG.TXT is never written.
//
// Threads: any number at once; a guard belongs to its thread. It costs about 20 ns and allocates
// only for an error.
#pragma once

#include <exception>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

namespace guard {

constexpr int kTextSize = 2048;

// Calls call(argument). Returns false if the engine reported an error; its text is then in `text`
// (kTextSize bytes).
bool Run(void (*call)(void*), void* argument, mjData* data, char* text);
[[noreturn]] void Throw(std::string_view context, const char* text);

// Keeps the result of `fn` outside of the frames that a jump discards.
template <class Function, class Result>
struct Call {
  std::remove_reference_t<Function>* fn;
  Result result{};
  std::exception_ptr thrown;

  static void Invoke(void* self) {
    auto* call = static_cast<Call*>(self);
    try {
      call->result = (*call->fn)();
    } catch (...) {
      call->thrown = std::current_exception();
    }
  }
};

template <class Function>
struct Call<Function, void> {
  std::remove_reference_t<Function>* fn;
  std::exception_ptr thrown;

  static void Invoke(void* self) {
    auto* call = static_cast<Call*>(self);
    try {
      (*call->fn)();
    } catch (...) {
      call->thrown = std::current_exception();
    }
  }
};

}  // namespace guard

// Runs fn() and returns its result; throws an engine error as EngineError("<context>: <engine's
// text>").
template <class Function>
auto Guarded(std::string_view context, mjData* data, Function&& fn) {
  using Result = std::invoke_result_t<Function&>;
  static_assert(
      std::is_trivially_destructible_v<std::remove_reference_t<Function>>,
      "a guarded function must capture by reference: an engine error would skip its destructors");
  static_assert(std::is_void_v<Result> || std::is_trivially_destructible_v<Result>,
                "a guarded function returns plain values or pointers");
  guard::Call<Function, Result> call{std::addressof(fn)};
  char text[guard::kTextSize];
  if (!guard::Run(&call.Invoke, &call, data, text)) guard::Throw(context, text);
  if (call.thrown) std::rethrow_exception(call.thrown);
  if constexpr (!std::is_void_v<Result>) return call.result;
}

template <class Function>
auto Guarded(std::string_view context, Function&& fn) {
  return Guarded(context, static_cast<mjData*>(nullptr), std::forward<Function>(fn));
}

// During its lifetime, the engine's warnings on this thread are kept here instead of being logged.
// Captures nest.
//
//   WarningCapture capture;
//   ... guarded engine calls ...
//   for (const std::string& text : capture.messages()) ...
class WarningCapture {
 public:
  WarningCapture();
  ~WarningCapture();
  WarningCapture(const WarningCapture&) = delete;
  WarningCapture& operator=(const WarningCapture&) = delete;

  const std::vector<std::string>& messages() const { return messages_; }
  void Add(std::string text) {
    messages_.push_back(std::move(text));
  }  // called by the engine's log handler

 private:
  WarningCapture* outer_;
  std::vector<std::string> messages_;
};

}  // namespace robocell::internal
