// The `task` of runs and environments: each kind's fields as a Python object that refers to them.
#include <memory>
#include <optional>
#include <utility>

#include "spec_kinds.h"
#include "spec_parts.h"
#include "robocell/base/error.h"
#include "robocell/spec/task_spec.h"

namespace robocell::python {

using namespace nb::literals;

namespace {

std::string TaskText(const KindFieldsView& view, nb::handle self) {
  std::string text = "TaskFields(kind='" + view.kind + "'";
  for (const KindFieldRef& field : view.fields->refs())
    text += ", " + field.name + "=" + nb::repr(GetKindField(field, self)).c_str();
  return text + ")";
}

std::vector<TaskClass>& TaskClasses() {
  static std::vector<TaskClass> classes;
  return classes;
}

TaskSpec TaskOfDict(const nb::dict& values, const FieldPath& path) {
  TaskSpec spec(KindOfDict(TaskKindRegistry(), values, path, TaskKindRegistry().default_kind()));
  SetKindFields(spec, values, path);
  return spec;
}

}  // namespace

void AddTaskClass(TaskClass added) {
  for (const TaskClass& known : TaskClasses()) {
    if (known.name == added.name) return;
  }
  TaskClasses().push_back(std::move(added));
}

std::string TaskTypes() {
  std::string types;
  for (const TaskClass& known : TaskClasses()) types += known.name + " | ";
  return types + "TaskFields | dict[str, typing.Any]";
}

nb::object TaskSpecToPython(TaskSpec& spec) {
  for (const TaskClass& known : TaskClasses()) {
    if (nb::object fields = known.to_python(spec)) return fields;
  }
  return nb::cast(KindFieldsView{spec.kind(), spec.shared_fields()});
}

TaskSpec TaskSpecFromPython(nb::handle value, const FieldPath& path) {
  if (nb::isinstance<nb::dict>(value)) return TaskOfDict(nb::borrow<nb::dict>(value), path);
  for (const TaskClass& known : TaskClasses()) {
    if (std::optional<TaskSpec> spec = known.from_python(value)) return *std::move(spec);
  }
  if (const KindFieldsView* view = nullptr; nb::try_cast(value, view, false) && view) {
    TaskSpec spec(view->kind);
    const std::vector<KindFieldRef> from = view->fields->refs();
    const std::vector<KindFieldRef> to = spec.fields().refs();
    // The kind may have been registered anew since.
    for (const KindFieldRef& field : to) {
      for (const KindFieldRef& other : from) {
        if (other.name != field.name || other.value.index() != field.value.index()) continue;
        std::visit(
            [&](auto* out) { *out = *std::get<std::remove_const_t<decltype(out)>>(other.value); },
            field.value);
      }
    }
    return spec;
  }
  ThrowType(path, "the fields of a task, for example {'kind': 'pick'}", value);
}

void BindTaskSpecs(nb::module_& m) {
  nb::class_<KindFieldsView>(
      m, "TaskFields",
      "Fields of a registered task, as attributes; the type of RunConfig.task and EnvConfig.task "
      "for such kinds. Changing one changes the configuration.")
      .def_ro("kind", &KindFieldsView::kind, "The kind of task, as in YAML.")
      .def(
          "__getattr__",
          [](nb::pointer_and_handle<KindFieldsView> self, const std::string& name) {
            return GetKindField(RequireKindField(*self.p->fields, "task", self.p->kind, name),
                                self.h);
          },
          "name"_a, nb::sig("def __getattr__(self, name: str, /) -> typing.Any"))
      .def(
          "__setattr__",
          [](KindFieldsView& view, const std::string& name, nb::handle value) {
            SetKindField(RequireKindField(*view.fields, "task", view.kind, name), value,
                         FieldPath(name));
          },
          "name"_a, "value"_a.none(),
          nb::sig("def __setattr__(self, name: str, value: typing.Any, /) -> None"))
      .def("__dir__",
           [](const KindFieldsView& view) {
             std::vector<std::string> names = view.fields->names();
             names.emplace_back("kind");
             return names;
           })
      .def(
          "to_dict",
          [](nb::pointer_and_handle<KindFieldsView> self) {
            nb::dict out;
            out["kind"] = self.p->kind;
            for (const KindFieldRef& field : self.p->fields->refs())
              out[field.name.c_str()] = GetKindField(field, self.h);
            return out;
          },
          "Kind and fields as a dictionary.")
      .def(
          "__eq__",
          [](const KindFieldsView& a, nb::handle other) -> nb::object {
            const KindFieldsView* b = nullptr;
            if (!nb::try_cast(other, b, false) || !b) return nb::borrow(Py_NotImplemented);
            return nb::bool_(a.kind == b->kind && a.fields->Equals(*b->fields));
          },
          "other"_a.none(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__repr__",
           [](nb::pointer_and_handle<KindFieldsView> self) { return TaskText(*self.p, self.h); });
}

}  // namespace robocell::python
