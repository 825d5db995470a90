// Ctrl-C and other signals while C++ works: their Python handlers run only when somebody asks.
#pragma once

#include <chrono>

#include "bindings.h"

namespace robocell::python {

// Called often from C++ code that works for long; asks Python every few milliseconds. Throws what a
// signal's handler raises (KeyboardInterrupt). Without the GIL or with it; handlers run on the main
// thread only, so on others it does nothing.
class SignalPoll {
 public:
  void operator()() {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(10);
    const nb::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  }

 private:
  std::chrono::steady_clock::time_point next_ =
      std::chrono::steady_clock::now() + std::chrono::milliseconds(10);
};

// The same for what is done in microseconds, such as a step of the engine: only every few calls
// look at the clock.
class SparsePoll {
 public:
  void operator()() {
    if (++calls_ % kCalls == 0) poll_();
  }

 private:
  static constexpr int kCalls = 8;
  int calls_ = 0;
  SignalPoll poll_;
};

}  // namespace robocell::python
