#include "handles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <unordered_map>

#include "robocell/base/error.h"

namespace robocell::python {
namespace {

struct GuardedClass {
  std::string name;
  HandleGuard guard;
  Excepted excepted;
};

// They live as long as the module.
auto& GuardedClasses() {
  static auto* classes = new std::unordered_map<PyObject*, GuardedClass>;
  return *classes;
}

// Finds `word` in `text`, not as part of another one.
bool HasWord(std::string_view text, std::string_view word) {
  const auto in_name = [](char c) {
    return c == '_' || std::isalnum(static_cast<unsigned char>(c));
  };
  for (size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
    const size_t end = at + word.size();
    if ((at == 0 || !in_name(text[at - 1])) && (end == text.size() || !in_name(text[end])))
      return true;
  }
  return false;
}

}  // namespace

SceneClaims::~SceneClaims() {
  for (auto use = more_.rbegin(); use != more_.rend(); ++use) (*use)->End();
  while (count_ > 0) claimed_[--count_]->End();
}

void SceneClaims::Add(SceneUse& use) {
  if (Has(use)) return;
  const bool is_one_of_many = count_ == claimed_.size();
  if (is_one_of_many) more_.reserve(more_.size() + 1);  // so that a begun claim can be recorded
  use.Begin(function_);
  if (is_one_of_many) return more_.push_back(&use);
  claimed_[count_++] = &use;
}

bool SceneClaims::Has(const SceneUse& use) const {
  const auto end = claimed_.begin() + count_;
  return std::find(claimed_.begin(), end, &use) != end ||
         std::find(more_.begin(), more_.end(), &use) != more_.end();
}

void AddGuard(nb::handle type, HandleGuard guard, Excepted excepted) {
  excepted.always.insert("__repr__");
  GuardedClasses()[type.ptr()] = {nb::cast<std::string>(type.attr("__name__")), std::move(guard),
                                  std::move(excepted)};
}

SelfCheck CheckOfSelf(nb::handle type, std::string_view function) {
  const auto it = GuardedClasses().find(type.ptr());
  if (it == GuardedClasses().end()) return {};
  const auto& [name, guard, excepted] = it->second;
  if (excepted.always.contains(function)) return {.never = true};
  return {.guard = &guard, .must_be_open = !excepted.closed.contains(function)};
}

bool TakesHandles(std::string_view signature) {
  const std::string_view parameters = signature.substr(0, signature.rfind("->"));
  return std::any_of(GuardedClasses().begin(), GuardedClasses().end(),
                     [&](const auto& guarded) { return HasWord(parameters, guarded.second.name); });
}

void UseArgument(nb::handle argument, SceneClaims& claims) {
  if (PyList_Check(argument.ptr()) || PyTuple_Check(argument.ptr())) {
    for (const nb::handle item : nb::borrow<nb::sequence>(argument)) UseArgument(item, claims);
    return;
  }
  if (PyDict_Check(argument.ptr())) {
    for (const auto& [key, item] : nb::borrow<nb::dict>(argument)) UseArgument(item, claims);
    return;
  }
  for (PyTypeObject* type = Py_TYPE(argument.ptr()); type; type = type->tp_base) {
    const auto it = GuardedClasses().find(reinterpret_cast<PyObject*>(type));
    if (it != GuardedClasses().end()) return it->second.guard(argument, claims, false);
  }
}

void RequireOpen(const Scene& scene, std::string_view thing) {
  if (!scene.closed()) return;
  throw ClosedError(fmt::format("{} is closed: its scene '{}' was closed", thing, scene.name()));
}

}  // namespace robocell::python
