// Exceptions that a user's Python code raises while C++ calls it. They become HookErrors, which C++
// handles like those of hooks in C++; where one reaches Python, the original is raised again.
//
//   return CallPython(self, "judge", [&] { return self.attr("judge")(scene); });
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <string>
#include <type_traits>

#include "robocell/base/hook_error.h"

namespace nb = nanobind;

namespace robocell::python {

// Returns where a function, a method or a class is written: "/folder/tasks.py:12, in judge"; "" for
// code that is not written in Python.
std::string PlaceOfCode(nb::handle function);
// Returns the place of a method of `self`. Takes the GIL.
std::string PlaceOfMethod(nb::handle self, const char* method);

// A HookError whose text names the class of the exception and the line that raised it.
class PythonHookError final : public HookError {
 public:
  PythonHookError(const std::string& message, const std::string& place,
                  const nb::python_error& error);
  std::string trace() const override;
  // Raises the original in Python. Needs the GIL.
  void Restore() const;
  // Makes the original the cause of the exception that is raised in Python. Needs the GIL.
  void BecomeCause() const;

 private:
  std::shared_ptr<const nb::python_error> error_;
};

// Rethrows the nb::python_error being handled as a PythonHookError; Ctrl-C, the end of a generator
// and the want of a policy, which are no failures of the code, as they are. `place_of_code` is named if no line of a
// user's code raised it.
[[noreturn]] void RethrowRaised(const std::string& place_of_code);
// The same for the function that makes a user's object. A SpecError passes as it is: the run cannot
// be made, while other errors may come from one of its starts.
[[noreturn]] void RethrowRaisedByMaker(nb::handle maker);
// Rethrows the exception of a conversion that is being handled as a HookError.
[[noreturn]] void RethrowAsHookError(const std::string& place);

// Calls a method of `self` that is written in Python. Needs the GIL.
template <class Call>
std::invoke_result_t<Call> CallPython(nb::handle self, const char* method, Call&& call) {
  try {
    return call();
  } catch (nb::python_error&) {
    RethrowRaised(PlaceOfMethod(self, method));
  }
}

// Calls a function that makes a task, an expert, a sampler or a scene source. Needs the GIL.
template <class... Args>
nb::object CallMaker(nb::handle maker, Args&&... args) {
  try {
    return maker(std::forward<Args>(args)...);
  } catch (nb::python_error&) {
    RethrowRaisedByMaker(maker);
  }
}

}  // namespace robocell::python
