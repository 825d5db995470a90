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

}  // namespace robocell::python
