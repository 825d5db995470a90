// Python objects that C++ keeps alive, released safely on any thread.
//
// A thread that does not hold the GIL must not wait for it (whoever holds it may be joining that
// thread): the object is put aside and released by the next thread that runs Python.
#pragma once

#include <functional>
#include <memory>

#include "bindings.h"
#include "returned.h"

namespace robocell::python {

// Holds a reference to `object`; get() is the PyObject. Copies share it. Needs the GIL to make, not
// to copy or destroy.
std::shared_ptr<void> KeepAlive(nb::object object);

// The object of such a keeper; invalid for any other pointer.
nb::object ObjectOf(const std::shared_ptr<void>& keeper);
// The same without a reference; null for any other pointer. Needs no GIL.
PyObject* TargetOf(const std::shared_ptr<void>& keeper);

// The C++ object that a Python object holds (an instance of a class bound here, or of a Python
// subclass of one), as C++ keeps it: the Python object lives as long.
// TypeError for a subclass whose __init__ did not call that of its base.
template <class T>
std::shared_ptr<T> Shared(nb::object object) {
  RequireInitialised(object);
  T* held = nb::cast<T*>(object);
  return {KeepAlive(std::move(object)), held};
}

// A keeper that several share and the collector may empty, to break a circle.
using SharedKeeper = std::shared_ptr<std::shared_ptr<void>>;

// Holds nothing for None.
inline SharedKeeper ShareKeeper(nb::object object) {
  auto keeper = std::make_shared<std::shared_ptr<void>>();
  if (!object.is_none()) *keeper = KeepAlive(std::move(object));
  return keeper;
}

// A reference to a Python object from C++ that several objects of Python's may share, which the
// collector cannot follow: a cycle through it may live until the interpreter ends. Then it is let
// go of. Copies share it.
class Held {
 public:
  explicit Held(nb::object object);  // with the GIL; copies need none

  // The referenced object; null after it was released.
  PyObject* target() const { return slot_->object ? slot_->object.get() : nullptr; }
  // The same, kept.
  std::shared_ptr<PyObject> share() const { return slot_->object; }

 private:
  friend void ReleaseHeld();
  struct Slot {
    std::shared_ptr<PyObject> object;
  };
  std::shared_ptr<Slot> slot_;
};

// A Python callable held so; once let go of, calls do nothing.
class Callback {
 public:
  explicit Callback(nb::object callable) : callable_(std::move(callable)) {}

  // Takes the GIL. Python's exceptions come through.
  void operator()(const std::function<nb::object()>& make_argument) const;
  PyObject* target() const { return callable_.target(); }

 private:
  Held callable_;
};

// Lets go of all that is held; called when the interpreter ends.
void ReleaseHeld();

// Releases what other threads have put aside.
void ReleaseAbandoned();

}  // namespace robocell::python
