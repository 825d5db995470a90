#include "robocell/mujoco/engine_exception.h"

#include <unwind.h>

#include <cstdint>
#include <string>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

thread_local EngineExceptions* innermost = nullptr;

// Common part of both of GCC's kinds of exceptions ("GNUCC++\0" and, rethrown, "GNUCC++\1").
constexpr uint64_t kOurRuntime = 0x474E5543432B2B00;
bool IsOurRuntimes(_Unwind_Exception_Class kind) { return (kind & ~uint64_t{0xff}) == kOurRuntime; }

}  // namespace

struct EngineExceptionHandler {
  [[noreturn]] static void GoOn() { std::longjmp(innermost->environment_, 1); }
};

EngineExceptions::EngineExceptions() : outer_(innermost) { innermost = this; }
EngineExceptions::~EngineExceptions() { innermost = outer_; }

}  // namespace robocell::internal

// The personality routine of the frame below (Itanium C++ ABI, "Exception Handling", 1.6 and 2.5).
// The thrower's runtime calls it; it never reads `context`, because that would use the wrong
// runtime's functions.
extern "C" __attribute__((visibility("hidden"), used)) _Unwind_Reason_Code
RobocellEngineExceptionPersonality(int /*version*/, _Unwind_Action actions,
                                   _Unwind_Exception_Class kind, _Unwind_Exception* exception,
                                   _Unwind_Context* /*context*/) {
  if (robocell::internal::IsOurRuntimes(kind)) return _URC_CONTINUE_UNWIND;
  if (actions & _UA_SEARCH_PHASE) return _URC_HANDLER_FOUND;
  if (!(actions & _UA_HANDLER_FRAME)) return _URC_CONTINUE_UNWIND;
  if (exception->exception_cleanup)
    exception->exception_cleanup(_URC_FOREIGN_EXCEPTION_CAUGHT, exception);
  robocell::internal::EngineExceptionHandler::GoOn();
}

// Has nothing to clean up, so that the compiler gives it no personality of its own.
extern "C" __attribute__((visibility("hidden"), noinline)) void RobocellCallEngine(
    void (*call)(void*), void* argument) {
  asm volatile(".cfi_personality 0x1b, RobocellEngineExceptionPersonality");
  call(argument);
  asm volatile("" ::: "memory");  // prevents a tail call
}

namespace robocell::internal {

void ThrowEngineThrew(std::string_view place) {
  throw EngineError(
      std::string(place) +
      ": the engine threw a C++ exception, as it does when a size is too large for the memory: "
      "look at the sizes of its hfield, texture, mesh, skin, flexcomp, replicate and size "
      "elements");
}

bool EngineExceptions::Catch(void (*call)(void*), void* argument) {
  if (setjmp(environment_) != 0) return false;
  RobocellCallEngine(call, argument);
  return true;
}

}  // namespace robocell::internal
