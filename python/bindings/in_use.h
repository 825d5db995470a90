// Objects that work without Python's lock, and may be used by one thread at a time: what a second
// thread asks for meanwhile is an Error, and no crash.
//
//   const InUse use(&env, "environment 'duo'", "stepped");  // to the end of the scope
//   { const nb::gil_scoped_release release; env.Step(action); }
//   ... RequireIdle(&env, "environment 'duo'");                   // in all other functions
#pragma once

#include <string>

namespace robocell::python {

class InUse {
 public:
  // Error "<thing> is being <done> by another thread" when somebody else uses it.
  InUse(const void* object, const std::string& thing, const char* done);
  ~InUse();
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  const void* object_;
};

// The same Error, unless it is this thread that uses it, as from a function of a task's.
void RequireIdle(const void* object, const std::string& thing);

}  // namespace robocell::python
