// Python objects that C++ keeps alive, released safely on any thread.
//
// A thread without the GIL must not wait for it (the owner of the GIL may be joining that thread):
// the object is queued and released by the next thread that runs Python.
#pragma once

#include <functional>
#include <memory>

#include "bindings.h"
#include "returned.h"

namespace robocell::python {

// Holds a reference to `object`; get() is the PyObject. Copies share it. Making it needs the GIL,
// copying and destroying do not.
std::shared_ptr<void> KeepAlive(nb::object object);

// Returns the object of such a keeper; invalid for any other pointer.
nb::object ObjectOf(const std::shared_ptr<void>& keeper);
// Returns the same without a reference; null for any other pointer. Needs no GIL.
PyObject* TargetOf(const std::shared_ptr<void>& keeper);

// Returns the C++ object inside a Python object (an instance of a class bound here, or of a Python
// subclass of one) as a pointer that keeps the Python object alive. Raises TypeError for a subclass
// whose __init__ did not call that of its base.
template <class T>
std::shared_ptr<T> Shared(nb::object object) {
  RequireInitialised(object);
  T* held = nb::cast<T*>(object);
  return {KeepAlive(std::move(object)), held};
}

// A keeper that several owners share and the collector may empty, to break a cycle.
using SharedKeeper = std::shared_ptr<std::shared_ptr<void>>;

// Holds nothing for None.
inline SharedKeeper ShareKeeper(nb::object object) {
  auto keeper = std::make_shared<std::shared_ptr<void>>();
  if (!object.is_none()) *keeper = KeepAlive(std::move(object));
  return keeper;
}

// A reference from C++ to a Python object that several Python objects may share, which the
// collector cannot follow: a cycle through it may live until the interpreter ends, which releases
// it. Copies share it.
class Held {
 public:
  explicit Held(nb::object object);  // needs the GIL; copies do not

  // The referenced object; null after it was released.
  PyObject* target() const { return slot_->object ? slot_->object.get() : nullptr; }
  // Returns a reference that keeps it alive.
  std::shared_ptr<PyObject> share() const { return slot_->object; }

 private:
  friend void ReleaseHeld();
  struct Slot {
    std::shared_ptr<PyObject> object;
  };
  std::shared_ptr<Slot> slot_;
};

// A Python callable held in this way; after its release, calls do nothing.
class Callback {
 public:
  explicit Callback(nb::object callable) : callable_(std::move(callable)) {}

  // Takes the GIL. Python's exceptions pass through.
  void operator()(const std::function<nb::object()>& make_argument) const;
  PyObject* target() const { return callable_.target(); }

 private:
  Held callable_;
};

// Releases all held objects; called when the interpreter ends.
void ReleaseHeld();

// Releases the objects that other threads have queued.
void ReleaseAbandoned();

}  // namespace robocell::python
