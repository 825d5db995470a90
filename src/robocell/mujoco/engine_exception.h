// C++ exceptions of the engine, for example for lack of memory while it compiles a model.
//
//   mjSpec* copy = Tried("copying", [&] { return mj_copySpec(spec); });
//
// Functions for specs, files and what is made from them (mjs_..., mj_parse..., mj_compile,
// mj_copySpec, mj_copyBack, mj_save..., virtual file systems) are the engine's C++ part: call these
// through Tried. The rest is C, for which Guarded (guard.h) is enough and takes half the time.
//
// The engine's library has its own C++ runtime. If such an exception reaches a frame of ours
// with a destructor or a `catch`, it ends the process: each runtime misreads the other's data.
// Therefore the call goes through a frame without a C++ runtime, whose handler only needs the
// address at which to continue. The engine's own frames are unwound first; the engine cleans up its
// own objects.
//
// One object per call, used by the thread that made it; objects of a thread nest.
#pragma once

#include <csetjmp>
#include <string_view>
#include <type_traits>

#include "robocell/mujoco/guard.h"

namespace robocell::internal {

class EngineExceptions {
 public:
  EngineExceptions();
  ~EngineExceptions();
  EngineExceptions(const EngineExceptions&) = delete;
  EngineExceptions& operator=(const EngineExceptions&) = delete;

  // Calls call(argument), which calls the engine and needs no destructors. Returns false if the
  // engine threw. Exceptions of our own runtime pass through, and so do the jumps of a guard
  // (guard.h).
  bool Catch(void (*call)(void*), void* argument);

 private:
  friend struct EngineExceptionHandler;
  std::jmp_buf environment_;
  EngineExceptions* outer_;
};

[[noreturn]] void ThrowEngineThrew(std::string_view place);

// Like Guarded, but the engine's C++ exceptions become EngineErrors too. Models with sizes beyond
// all memory make the engine throw.
template <class Function>
auto Tried(std::string_view place, Function&& fn) {
  using Result = std::invoke_result_t<Function&>;
  EngineExceptions exceptions;
  if constexpr (std::is_void_v<Result>) {
    const auto call = [](void* self) {
      (*static_cast<std::remove_reference_t<Function>*>(self))();
    };
    if (!Guarded(place, [&] { return exceptions.Catch(call, &fn); })) ThrowEngineThrew(place);
  } else {
    struct Call {
      std::remove_reference_t<Function>* fn;
      Result result;
      static void Run(void* self) {
        auto* call = static_cast<Call*>(self);
        call->result = (*call->fn)();
      }
    } call{&fn, {}};
    if (!Guarded(place, [&] { return exceptions.Catch(&Call::Run, &call); }))
      ThrowEngineThrew(place);
    return call.result;
  }
}

}  // namespace robocell::internal
