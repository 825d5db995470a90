// Objects that work without Python's lock, and may be used by one thread at a time: what a second
// thread asks for meanwhile is an Error, and no crash.
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

// Who uses an object, and what is done with it.
struct Use {
  std::thread::id thread;
  const char* done = "";
};

// Claims an object, unless somebody uses it: who that is.
std::optional<Use> Claim(const void* object, const char* done);
void Release(const void* object);
// Calls f while nobody else uses the object: now, or at the end of the call that uses it, on that
// call's thread. Needs Python's lock.
void WhenIdle(const void* object, std::function<void()> f);
// The thread that uses it, if that is another one.
std::optional<Use> UseByOthers(const void* object);
// Error "<thing> is being <done> by another thread".
[[noreturn]] void ThrowInUse(const std::string& thing, const Use& use);

class InUse {
 public:
  // Error when somebody else uses it. Names are made for messages only: steps are counted in
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

// The same Error, unless it is this thread that uses it, as from a function of a task's.
template <class T>
void RequireIdle(const T& object, std::string (*place)(const std::type_identity_t<T>&)) {
  if (const std::optional<Use> use = UseByOthers(&object)) ThrowInUse(place(object), *use);
}

}  // namespace robocell::python
