// Scenes in reference cycles, as Python's collector sees them.
//
// A scene keeps reset hooks and groups that are written in Python, and these may refer to any
// handle to it: the scene, its robots, their groups, controllers, kinematics, its renderers ... All
// handles share one C++ object, which the collector does not see. So a scene that keeps anything of
// Python's gets a node, a Python object that stands for it: the node visits what the scene keeps,
// and each handle visits the node once for every Scene that it has in C++. When a collection
// starts, the node is given as many references as there are such Scenes. Then it is garbage exactly
// when all of them are in garbage; those that C++ alone has (an environment's, a port's) are never
// visited, so that what they use stays.
//
//   nb::class_<Robot> robot(m, "Robot", "...", nb::type_slots(kHandleSlots<Robot>));
//   TrackScene(scene);  // whenever it is given something of Python's to keep
//
// All with the GIL.
#pragma once

#include <memory>
#include <vector>

#include "python_owner.h"
#include "robocell/robot/move_group.h"
#include "robocell/scene/scene.h"

namespace robocell::python {

// The argument of a Python hook; copies, so that keeping it is harmless.
struct HookContext {
  Scene scene;
  ResetOptions options;
  ResetInfo info;
};

struct PythonHook {
  Callback callback;

  void operator()(ResetContext& reset) const;
};

// Gives the scene a node, if it has none.
void TrackScene(const Scene& scene);

// For tp_traverse of a handle, once for each Scene that it alone has.
int VisitScene(const Scene& scene, visitproc visit, void* arg);

// `groups` are copies of the pointers that one owner keeps alive; a group that anybody else keeps
// too is passed over.
int VisitGroups(const std::vector<std::shared_ptr<MoveGroup>>& groups, visitproc visit, void* arg);

// Visits the scene of a handle with one Scene.
template <class T>
int VisitHandle(const T& handle, visitproc visit, void* arg) {
  return VisitScene(handle.scene(), visit, arg);
}

// How Python has a handle: as a value of its own (or it refers to one inside of another object,
// which is then the one that has a Scene), or by a shared_ptr that holds one Scene.
enum class HandleIs { kValue, kShared };

template <class T, int (*kVisit)(const T&, visitproc, void*), HandleIs kIs>
int TraverseHandle(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  const auto [ready, is_own] = nb::inst_state(self);
  if (!ready || (kIs == HandleIs::kValue && !is_own)) return 0;
  return kVisit(*nb::inst_ptr<T>(self), visit, arg);
}

// Nothing is cleared: a cycle ends where its node lets go of what the scene keeps.
template <class T, int (*kVisit)(const T&, visitproc, void*) = &VisitHandle<T>,
          HandleIs kIs = HandleIs::kValue>
inline PyType_Slot kHandleSlots[] = {
    {Py_tp_traverse, reinterpret_cast<void*>(&TraverseHandle<T, kVisit, kIs>)}, {0, nullptr}};

void BindSceneNodes(nb::module_& m);

}  // namespace robocell::python
