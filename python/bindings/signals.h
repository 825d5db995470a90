// Ctrl-C and other signals while C++ works: their Python handlers only run on request.
#pragma once

#include <chrono>

#include "bindings.h"
#include "robocell/base/poll_clock.h"

namespace robocell::python {

// Runs the handlers of pending signals, and throws their exceptions (KeyboardInterrupt). Works
// without the GIL or with it; handlers run on the main thread only, so on others it does nothing.
inline void HearSignals() {
  const nb::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

// Call it often in long-running C++ code; it runs handlers every few milliseconds.
class SignalPoll {
 public:
  void operator()() {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(10);
    HearSignals();
  }

 private:
  std::chrono::steady_clock::time_point next_ =
      std::chrono::steady_clock::now() + std::chrono::milliseconds(10);
};

// The same for work that may take microseconds, such as a step of the engine.
class SparsePoll {
 public:
  void operator()() {
    if (clock_.IsDue()) HearSignals();
  }

 private:
  PollClock clock_;
};

}  // namespace robocell::python
