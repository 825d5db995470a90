// Objects that work without Python's lock, and may be used by one thread at a time: a call of a
// second thread meanwhile is an Error instead of a crash.
//
//   const InUse use(env, &Place, "stepped");  // to the end of the scope; Place(env) is its name
//   { const nb::gil_scoped_release release; env.Step(action); }
//   ... RequireIdle(env, &Place);             // in all other functions
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>

namespace robocell::python {

// The thread that uses an object, and its action.
struct Use {
  std::thread::id thread;
  const char* done = "";
};

// Claims an object, unless another thread uses it: then returns that use.
std::optional<Use> Claim(const void* object, const char* done);
void Release(const void* object);
// Calls f while no thread uses the object: now, or at the end of the call that uses it, on that
// call's thread. Needs Python's lock.
void WhenIdle(const void* object, std::function<void()> f);
// Returns the use by another thread, if any.
std::optional<Use> UseByOthers(const void* object);
// Throws Error "<thing> is being <done> by another thread".
[[noreturn]] void ThrowInUse(const std::string& thing, const Use& use);

class InUse {
 public:
  // Throws Error if another thread uses it. Names are made for messages only: steps take
  // microseconds.
  template <class T>
  InUse(const T& object, std::string (*place)(const std::type_identity_t<T>&), const char* done)
      : object_(&object) {
    if (const std::optional<Use> use = Claim(&object, done)) ThrowInUse(place(object), *use);
  }
  ~InUse() { Release(object_); }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  const void* object_;
};

// Throws the same Error, unless this thread uses it, for example through a task's function.
template <class T>
void RequireIdle(const T& object, std::string (*place)(const std::type_identity_t<T>&)) {
  if (const std::optional<Use> use = UseByOthers(&object)) ThrowInUse(place(object), *use);
}

}  // namespace robocell::python
