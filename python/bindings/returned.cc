#include "returned.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "robocell/base/hook_error.h"
#include "robocell/expert/expert.h"
#include "robocell/task/task.h"
#include "robocell/task/task_sampler.h"

namespace robocell::python {
namespace {

constexpr size_t kMostRepr = 120;  // characters of a repr that a message shows

std::string TypeOf(nb::handle value) {
  return value.is_none() ? "None" : std::string("a ") + Py_TYPE(value.ptr())->tp_name;
}

// Returns the problem of {robot: {group: GroupCommand}}; "" for none.
std::string WrongInAction(nb::handle action) {
  if (!nb::isinstance<nb::dict>(action)) return "got " + ShortRepr(action);
  for (const auto& [robot, groups] : nb::borrow<nb::dict>(action)) {
    const std::string place = "[" + ShortRepr(robot) + "]";
    if (!nb::isinstance<nb::str>(robot)) return place + " is not the name of a robot";
    if (nb::isinstance<GroupCommand>(groups))
      return place + " is a GroupCommand: the outer keys are robots, the inner ones their groups";
    if (!nb::isinstance<nb::dict>(groups))
      return place + " is " + TypeOf(groups) + ", not {group: GroupCommand}";
    for (const auto& [group, command] : nb::borrow<nb::dict>(groups)) {
      const std::string inner = place + "[" + ShortRepr(group) + "]";
      if (!nb::isinstance<nb::str>(group)) return inner + " is not the name of a group";
      if (!nb::isinstance<GroupCommand>(command)) {
        return inner + " is " + TypeOf(command) +
               ", not a GroupCommand such as GroupCommand.joints(q)";
      }
    }
  }
  return "";
}

// Returns "; an Expert has act, begin, ...": the methods of robocell's class that `self` derives
// from.
std::string WhatItHas(nb::handle self) {
  for (nb::handle base : nb::borrow<nb::tuple>(self.type().attr("__mro__"))) {
    const auto module = nb::cast<std::string>(nb::str(base.attr("__module__")));
    if (module != "robocell" && !module.starts_with("robocell.")) continue;
    std::vector<std::string> methods;
    const nb::object members = base.attr("__dict__");
    for (nb::handle item : members) {
      const auto name = nb::cast<std::string>(nb::str(item));
      if (!name.starts_with("_")) methods.push_back(name);
    }
    const auto name = nb::cast<std::string>(nb::str(base.attr("__name__")));
    const bool vowel = std::string("AEIOU").find(name.front()) != std::string::npos;
    return fmt::format("; {} {} has {}", vowel ? "an" : "a", name, fmt::join(methods, ", "));
  }
  return "";
}

}  // namespace

std::string ClassName(nb::handle self) {
  return nb::cast<std::string>(nb::str(self.type().attr("__name__")));
}

std::string ShortRepr(nb::handle value) {
  std::string text = nb::cast<std::string>(nb::repr(value));
  if (text.size() <= kMostRepr) return text;
  size_t end = kMostRepr;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // whole UTF-8
  return text.substr(0, end) + " ...";
}

void ThrowReturned(const std::string& what, const std::string& expected, nb::handle got,
                   const std::string& place) {
  throw HookError(fmt::format("{} must return {}, got {}", what, expected, ShortRepr(got)), place,
                  HookError::Kind::kType);
}

void ThrowReturned(nb::handle self, const char* method, const std::string& expected,
                   nb::handle got) {
  ThrowReturned(ClassName(self) + "." + method + "()", expected, got, PlaceOfMethod(self, method));
}

void ThrowMissing(nb::handle self, const char* method) {
  const nb::gil_scoped_acquire gil;
  throw HookError(fmt::format("{} must define {}(){}", ClassName(self), method, WhatItHas(self)),
                  "", HookError::Kind::kType);
}

void RequireInitialised(nb::handle object) {
  if (!nb::inst_check(object) || nb::inst_ready(object)) return;
  throw nb::type_error(fmt::format("{0}.__init__() must call super().__init__(...) before the {0} "
                                   "can be used",
                                   ClassName(object))
                           .c_str());
}

void RequireCallable(nb::handle value, const char* argument, const char* expected) {
  if (value.is_none() || PyCallable_Check(value.ptr())) return;
  const std::string made = nb::isinstance<TaskSampler>(value) || nb::isinstance<Expert>(value)
                               ? fmt::format(
                                     "an instance of {0}; give the function that makes it, such as "
                                     "lambda *_: {0}(...)",
                                     ClassName(value))
                               : ShortRepr(value);
  throw nb::type_error(
      fmt::format("Runner: `{}` must be {}, got {}", argument, expected, made).c_str());
}

Action ReturnedAction(nb::handle self, const char* method, nb::handle value) {
  Action action;
  if (nb::try_cast(value, action)) return action;
  throw HookError(fmt::format("{}.{}() must return {{robot: {{group: GroupCommand}}}}: {}",
                              ClassName(self), method, WrongInAction(value)),
                  PlaceOfMethod(self, method), HookError::Kind::kType);
}

}  // namespace robocell::python
