// Checks of handles to a scene and to objects that belong to one (groups, controllers, renderers
// ...), for every call:
// - Another thread that uses the scene meanwhile is an Error (scene_use.h). Long calls release
// Python's lock, so a second thread could change the scene of the first one. Calls claim the scenes
// of their object and of all handles among their arguments, until they end.
// - After the scene was closed a call raises ClosedError.
//
// All functions of their classes begin with these checks. argument_errors.cc wraps all functions in
// one place, so that no function lacks them.
//
//   GuardHandle<MoveGroup>(
//       cls, [](const MoveGroup& g, SceneClaims& claims) { claims.Add(g.scene()); },
//       [](const MoveGroup& g) { g.RequireOpen(); }, {.always = {"name", "kind"}});
#pragma once

#include <array>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bindings.h"
#include "robocell/base/error.h"
#include "robocell/scene/scene.h"

namespace robocell::python {

// The scenes that one call of a function uses; claimed until the call ends.
class SceneClaims {
 public:
  // `function`: its name, for the Error that another thread gets meanwhile. It lives as long as the
  // module.
  explicit SceneClaims(const char* function) : function_(function) {}
  ~SceneClaims();
  SceneClaims(const SceneClaims&) = delete;
  SceneClaims& operator=(const SceneClaims&) = delete;

  // Throws Error if another thread uses it.
  void Add(SceneUse& use);
  void Add(const Scene& scene) { Add(scene.use()); }
  void Add(const Scene* scene) {  // nothing for null
    if (scene) Add(*scene);
  }

 private:
  const char* function_;
  bool Has(const SceneUse& use) const;

  std::array<SceneUse*, 8> claimed_;  // the first, without an allocation
  size_t count_ = 0;
  std::vector<SceneUse*> more_;
};

// Claims the scene of an object, then requires that it is open, if necessary.
using HandleGuard = std::function<void(nb::handle self, SceneClaims&, bool must_be_open)>;

// Functions with fewer checks: `always` has those without any check, because their result never
// changes; `closed` those that also work with a closed handle.
struct Excepted {
  std::set<std::string, std::less<>> always = {}, closed = {};
};

// Applies to the functions that `type` itself defines, and to its handles among the arguments of
// all functions. `__repr__` is always excepted.
void AddGuard(nb::handle type, HandleGuard guard, Excepted excepted);

// The checks of the object of a class's function: none without a guard; with `never` none of its
// arguments either.
struct SelfCheck {
  bool never = false;
  const HandleGuard* guard = nullptr;
  bool must_be_open = true;
};
SelfCheck CheckOfSelf(nb::handle type, std::string_view function);
// Returns true if a Python signature has a parameter of such a class.
bool TakesHandles(std::string_view signature);
// Claims the scenes of an argument that is a handle, or a list, tuple or dict of handles.
void UseArgument(nb::handle argument, SceneClaims& claims);

template <class T, class Use, class RequireOpen>
void GuardHandle(nb::handle type, Use use, RequireOpen require_open, Excepted excepted = {}) {
  AddGuard(
      type,
      [=](nb::handle self, SceneClaims& claims, bool must_be_open) {
        if (!nb::isinstance<T>(self) || !nb::inst_ready(self)) return;
        const T& handle = *nb::inst_ptr<T>(self);
        use(handle, claims);
        if (must_be_open) require_open(handle);
      },
      std::move(excepted));
}

// Makes the exception being handled the present Python error, with the same class as everywhere
// else.
void SetCaughtError();

// Throws ClosedError "<thing> is closed: its scene 'pick' was closed".
void RequireOpen(const Scene& scene, std::string_view thing);

}  // namespace robocell::python
