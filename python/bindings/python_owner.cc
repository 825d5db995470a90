#include "python_owner.h"

#include <mutex>
#include <vector>

namespace robocell::python {
namespace {

std::mutex mutex;
std::vector<PyObject*> abandoned;  // guarded by mutex

int ReleaseAbandonedPending(void*) {
  ReleaseAbandoned();
  return 0;
}

// Returns true if this thread may use Python's objects; also while the interpreter ends and its
// modules are destroyed, when Py_IsInitialized() is already false.
bool HoldsGil() {
#if PY_VERSION_HEX >= 0x030D0000
  const PyThreadState* running = PyThreadState_GetUnchecked();
#else
  const PyThreadState* running = _PyThreadState_UncheckedGet();
#endif
  return running != nullptr && PyGILState_Check() == 1;
}

struct DropObject {
  PyObject* object;  // a pointer to a part of it finds it too

  void operator()(void*) const noexcept {
    if (HoldsGil()) return Py_DECREF(object);
    if (!Py_IsInitialized()) return;
    {
      const std::lock_guard<std::mutex> lock(mutex);
      abandoned.push_back(object);
    }
    Py_AddPendingCall(&ReleaseAbandonedPending,
                      nullptr);  // a later call does it if its queue is full
  }
};

// Guarded by the GIL; never destroyed, because some users outlive static objects.
auto& Slots() {
  static auto* slots = new std::vector<std::weak_ptr<void>>;
  return *slots;
}

}  // namespace

Held::Held(nb::object object) : slot_(std::make_shared<Slot>()) {
  PyObject* held = object.release().ptr();
  slot_->object = {held, DropObject{held}};
  std::erase_if(Slots(), [](const auto& slot) { return slot.expired(); });
  Slots().push_back(slot_);
}

void Callback::operator()(const std::function<nb::object()>& make_argument) const {
  const nb::gil_scoped_acquire gil;
  const std::shared_ptr<PyObject> callable = callable_.share();  // it may replace itself
  if (callable) nb::handle(callable.get())(make_argument());
}

void ReleaseHeld() {
  for (const auto& weak : std::vector(Slots())) {  // releasing one may drop others
    if (const auto slot = weak.lock()) static_cast<Held::Slot*>(slot.get())->object.reset();
  }
}

std::shared_ptr<void> KeepAlive(nb::object object) {
  PyObject* held = object.release().ptr();
  return {static_cast<void*>(held), DropObject{held}};
}

PyObject* TargetOf(const std::shared_ptr<void>& keeper) {
  const DropObject* release = keeper ? std::get_deleter<DropObject>(keeper) : nullptr;
  return release ? release->object : nullptr;
}

nb::object ObjectOf(const std::shared_ptr<void>& keeper) {
  PyObject* object = TargetOf(keeper);
  return object ? nb::borrow(object) : nb::object();
}

void ReleaseAbandoned() {
  std::vector<PyObject*> objects;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    objects.swap(abandoned);
  }
  for (PyObject* object : objects) Py_DECREF(object);
}

}  // namespace robocell::python
