// Scenes in reference cycles, for Python's collector.
//
// A scene keeps reset hooks and groups that are written in Python, and these may refer to any
// handle to it: the scene, its robots, their groups, controllers, kinematics, its renderers ... All
// handles share one C++ object, which the collector does not see. Therefore a scene that keeps a
// Python object gets a node, a Python object that represents it: the node visits the objects that
// the scene keeps, and each handle visits the node once for every Scene that it has in C++. When a
// collection starts, the node gets as many references as there are such Scenes. Then it is garbage
// exactly if all of them are in garbage; Scenes that only C++ has (a port's) are never
// visited, so that the objects which they use stay.
//
//   nb::class_<Robot> robot(m, "Robot", "...", nb::type_slots(kHandleSlots<Robot>));
//   TrackScene(scene);  // whenever it is given something of Python's to keep
//
// All functions need the GIL.
#pragma once

#include <memory>
#include <vector>

#include "python_owner.h"
#include "robocell/robot/move_group.h"
#include "robocell/scene/scene.h"

namespace robocell::python {

// The argument of a Python hook; it consists of copies, so that Python may keep it.
struct HookContext {
  Scene scene;
  ResetOptions options;
  ResetInfo info;
};

struct PythonHook {
  Callback callback;

  void operator()(ResetContext& reset) const;
};

// Gives the scene a node if it has none.
void TrackScene(const Scene& scene);

// Visits a handle in tp_traverse, once for each Scene that it alone has.
int VisitScene(const Scene& scene, visitproc visit, void* arg);

// `groups` are copies of the pointers that one owner keeps alive; a group with another owner too is
// skipped.
int VisitGroups(const std::vector<std::shared_ptr<MoveGroup>>& groups, visitproc visit, void* arg);

// Visits the scene of a handle with one Scene.
template <class T>
int VisitHandle(const T& handle, visitproc visit, void* arg) {
  return VisitScene(handle.scene(), visit, arg);
}

// Python's ownership of a handle: as a separate value (or as a reference to one inside another
// object, which then has the Scene), or by a shared_ptr that holds one Scene.
enum class HandleIs { kValue, kShared };

template <class T, int (*kVisit)(const T&, visitproc, void*), HandleIs kIs>
int TraverseHandle(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  const auto [ready, is_own] = nb::inst_state(self);
  if (!ready || (kIs == HandleIs::kValue && !is_own)) return 0;
  return kVisit(*nb::inst_ptr<T>(self), visit, arg);
}

// Clears nothing: a cycle ends when its node releases the objects that the scene keeps.
template <class T, int (*kVisit)(const T&, visitproc, void*) = &VisitHandle<T>,
          HandleIs kIs = HandleIs::kValue>
inline PyType_Slot kHandleSlots[] = {
    {Py_tp_traverse, reinterpret_cast<void*>(&TraverseHandle<T, kVisit, kIs>)}, {0, nullptr}};

void BindSceneNodes(nb::module_& m);

}  // namespace robocell::python
