// C++ exceptions that the engine throws, such as for want of memory while it compiles a model.
//
//   EngineExceptions exceptions;                 // outside of the guard
//   bool threw = false;
//   Guarded(place, [&] { threw = !exceptions.Catch(&Compile, &arguments); });
//
// The engine's library has a C++ runtime of its own. A frame of ours with a destructor or a `catch`
// that such an exception reaches ends the process: the two runtimes read each other's data wrongly.
// So the call is made through a frame of no C++ runtime, whose handler asks neither for anything
// but where to go on. The engine's own frames are unwound first; whatever was made is the engine's
// to clean up.
//
// One object per call, used by the thread that made it; objects of a thread nest.
#pragma once

#include <csetjmp>

namespace robocell {

class EngineExceptions {
 public:
  EngineExceptions();
  ~EngineExceptions();
  EngineExceptions(const EngineExceptions&) = delete;
  EngineExceptions& operator=(const EngineExceptions&) = delete;

  // Calls call(argument), which calls the engine and needs no destructors. False when the engine
  // threw. Exceptions of our own runtime pass through, and so do the jumps of a guard (guard.h).
  bool Catch(void (*call)(void*), void* argument);

 private:
  friend struct EngineExceptionHandler;
  std::jmp_buf environment_;
  EngineExceptions* outer_;
};

}  // namespace robocell
