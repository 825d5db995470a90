// Handles to what belongs to a scene (groups, controllers, renderers ...) raise ClosedError after
// the scene was closed, whatever is asked of them: every function of their classes begins with that
// question. It is asked in one place (argument_errors.cc wraps all functions), so none can forget.
//
//   GuardHandle<MoveGroup>(cls, [](const MoveGroup& g) { g.RequireOpen(); }, {"name", "kind"});
#pragma once

#include <functional>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "bindings.h"
#include "robocell/base/error.h"
#include "robocell/scene/scene.h"

namespace robocell::python {

// Throws ClosedError, or Error when another thread uses the object (in_use.h).
using HandleGuard = std::function<void(nb::handle self)>;
using Names = std::initializer_list<const char*>;

// For the functions that `type` itself defines, but for those in `always`, which tell what the
// object is or end its use.
void AddGuard(nb::handle type, HandleGuard guard, Names always);

// The guard of a function of a class; null when it has none.
const HandleGuard* GuardOf(nb::handle type, std::string_view function);

template <class T, class RequireOpen>
void GuardHandle(nb::handle type, RequireOpen require_open, Names always = {}) {
  AddGuard(
      type,
      [require_open = std::move(require_open)](nb::handle self) {
        if (nb::isinstance<T>(self) && nb::inst_ready(self)) require_open(*nb::inst_ptr<T>(self));
      },
      always);
}

// Makes the exception that is being handled the present Python error, of the class that it has
// everywhere else.
void SetCaughtError();

// ClosedError "<thing> is closed: its scene 'pick' was closed".
void RequireOpen(const Scene& scene, std::string_view thing);

}  // namespace robocell::python
