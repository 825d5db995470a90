#include "closed_handles.h"

#include <fmt/format.h>

#include <set>
#include <string>
#include <unordered_map>

#include "robocell/base/error.h"

namespace robocell::python {
namespace {

struct GuardedClass {
  HandleGuard guard;
  std::set<std::string, std::less<>> always;
};

// They live as long as the module.
auto& GuardedClasses() {
  static auto* classes = new std::unordered_map<PyObject*, GuardedClass>;
  return *classes;
}

}  // namespace

void AddGuard(nb::handle type, HandleGuard guard, Names always) {
  GuardedClass guarded{std::move(guard), {"__init__", "__new__", "__repr__"}};
  for (const char* name : always) guarded.always.emplace(name);
  GuardedClasses()[type.ptr()] = std::move(guarded);
}

const HandleGuard* GuardOf(nb::handle type, std::string_view function) {
  const auto it = GuardedClasses().find(type.ptr());
  if (it == GuardedClasses().end() || it->second.always.contains(function)) return nullptr;
  return &it->second.guard;
}

void RequireOpen(const Scene& scene, std::string_view thing) {
  if (!scene.closed()) return;
  throw ClosedError(fmt::format("{} is closed: its scene '{}' was closed", thing, scene.name()));
}

}  // namespace robocell::python
