#include "scene_cycles.h"

#include <unordered_map>

#include "move_group_trampoline.h"
#include "robocell/robot/robot.h"

namespace robocell::python {
namespace {

// A scene as Python's collector sees it.
struct SceneNode {
  Scene::Weak scene;
};

struct Tracked {
  Scene::Weak scene;
  PyObject* node = nullptr;
  size_t references = 0;  // references to the node, held here
};

// Keyed by the scene's id; guarded by the GIL, and never destroyed, because some users outlive
// static objects.
auto& TrackedScenes() {
  static auto* tracked = new std::unordered_map<size_t, Tracked>;
  return *tracked;
}

// Holds one reference for each handle; the last ones go with the scene.
void CountHandles(Tracked& tracked, size_t handles) {
  for (; tracked.references < handles; ++tracked.references) Py_INCREF(tracked.node);
  for (; tracked.references > handles; --tracked.references) Py_DECREF(tracked.node);
}

void OnCollection(const std::string& phase, nb::handle) {
  if (phase != "start") return;
  for (auto& [id, tracked] : TrackedScenes()) CountHandles(tracked, tracked.scene.handles());
  std::erase_if(TrackedScenes(), [](const auto& entry) { return entry.second.references == 0; });
}

void StopTracking() {
  for (auto& [id, tracked] : TrackedScenes()) CountHandles(tracked, 0);
  TrackedScenes().clear();
}

// Collections are observed from the first node to the end of the interpreter.
void WatchCollections() {
  static bool watched = false;
  if (watched) return;
  watched = true;
  const nb::object callbacks = nb::module_::import_("gc").attr("callbacks");
  const nb::object callback = nb::cpp_function(&OnCollection);
  callbacks.attr("append")(callback);
  nb::module_::import_("atexit").attr("register")(nb::cpp_function([callbacks, callback] {
    StopTracking();
    if (nb::cast<bool>(callbacks.attr("__contains__")(callback)))
      callbacks.attr("remove")(callback);
  }));
}

int TraverseNode(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (!nb::inst_ready(self)) return 0;
  const std::optional<Scene> scene = nb::inst_ptr<SceneNode>(self)->scene.lock();
  if (!scene) return 0;
  for (const auto& [id, hook] : scene->reset_hooks()) {
    if (const auto* python = hook.target<PythonHook>()) Py_VISIT(python->callback.target());
  }
  return VisitGroups(GroupsKeptBy(*scene), visit, arg);
}

int ClearNode(PyObject* self) {
  if (!nb::inst_ready(self)) return 0;
  std::optional<Scene> scene = nb::inst_ptr<SceneNode>(self)->scene.lock();
  if (!scene) return 0;
  scene->ClearResetHooks();
  scene->ForgetKeptObservers();
  return 0;
}

PyType_Slot node_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&TraverseNode)},
                            {Py_tp_clear, reinterpret_cast<void*>(&ClearNode)},
                            {0, nullptr}};

}  // namespace

void PythonHook::operator()(ResetContext& reset) const {
  callback([&] { return nb::cast(HookContext{reset.scene.outer(), reset.options, reset.info}); });
}

void TrackScene(const Scene& scene) {
  WatchCollections();
  if (TrackedScenes().contains(scene.id())) return;
  const Scene::Weak weak(scene);
  TrackedScenes().emplace(scene.id(), Tracked{weak, nb::cast(SceneNode{weak}).release().ptr(), 1});
}

int VisitScene(const Scene& scene, visitproc visit, void* arg) {
  const auto tracked = TrackedScenes().find(scene.id());
  if (tracked != TrackedScenes().end()) Py_VISIT(tracked->second.node);
  return 0;
}

int VisitGroups(const std::vector<std::shared_ptr<MoveGroup>>& groups, visitproc visit, void* arg) {
  for (const auto& group : groups) {
    if (group.use_count() != 2) continue;
    const auto* own = dynamic_cast<const WrittenInPython*>(group.get());
    Py_VISIT(own ? own->python_object() : TargetOf(group));
  }
  return 0;
}

void BindSceneNodes(nb::module_& m) {
  nb::class_<SceneNode>(m, "_SceneNode", "The part of a scene that Python's collector visits.",
                        nb::type_slots(node_slots));
}

}  // namespace robocell::python
