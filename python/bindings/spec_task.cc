// The `task` of runs and environments: each kind's fields as a Python object that refers to them.
#include <memory>

#include "spec_class.h"
#include "spec_parts.h"
#include "robocell/base/error.h"
#include "robocell/spec/pick_task_config.h"
#include "robocell/spec/task_spec.h"

namespace robocell::python {

using namespace nb::literals;

namespace {

// The fields of a kind that has no class of its own here.
struct TaskFieldsView {
  std::string kind;
  std::shared_ptr<TaskFields> fields;
};

TaskFieldRef RequireField(TaskFields& fields, const std::string& kind, const std::string& name) {
  for (TaskFieldRef& field : fields.refs()) {
    if (field.name == name) return std::move(field);
  }
  throw nb::attribute_error(
      NoSuchName("task '" + kind + "'", "field", name, fields.names()).c_str());
}

nb::object GetField(const TaskFieldRef& field, nb::handle owner) {
  return std::visit(
      [&](auto* value) -> nb::object {
        using Value = std::remove_pointer_t<decltype(value)>;
        return Convert<Value>::Get(*value, field.name.c_str(), owner);
      },
      field.value);
}

void SetField(const TaskFieldRef& field, nb::handle from, const FieldPath& path) {
  std::visit(
      [&](auto* value) {
        using Value = std::remove_pointer_t<decltype(value)>;
        Convert<Value>::Set(*value, from, path);
      },
      field.value);
}

std::string TaskText(const TaskFieldsView& view, nb::handle self) {
  std::string text = "TaskFields(kind='" + view.kind + "'";
  for (const TaskFieldRef& field : view.fields->refs())
    text += ", " + field.name + "=" + nb::repr(GetField(field, self)).c_str();
  return text + ")";
}

template <IsTaskConfig T>
nb::object ToObject(TaskSpec& spec) {
  return nb::cast(std::shared_ptr<T>(spec.shared_fields(), spec.If<T>()));
}

TaskSpec FromDict(const nb::dict& values, const FieldPath& path) {
  std::string kind = PickTaskConfig::kKind;
  if (values.contains("kind")) kind = ToText(values["kind"], FieldPath(path, "kind"));
  if (!IsTaskKind(kind)) {
    throw NotFoundError(NoSuchName(path.text() + ".kind", "task", kind, TaskKinds()) +
                        " A task of your own is registered with register_task");
  }
  TaskSpec spec(kind);
  for (const auto& [key, value] : values) {
    const std::string name = ToText(key, FieldPath("field name"));
    if (name == "kind") continue;
    const std::vector<std::string> names = spec.fields().names();
    if (std::ranges::find(names, name) == names.end()) {
      std::vector<std::string> all = names;
      all.insert(all.begin(), "kind");
      throw nb::type_error(NoSuchName(path.text() + ": " + WithArticle(spec.fields().type_name()),
                                      "field", name, all)
                               .c_str());
    }
    SetField(RequireField(spec.fields(), kind, name), value, FieldPath(path, name));
  }
  return spec;
}

template <IsTaskConfig T>
void BindTaskConfig(nb::module_& m, const char* doc) {
  BindSpecClass<T>(m, doc).def_prop_ro(
      "kind", [](const T&) { return std::string(T::kKind); }, "The kind of task, as in YAML.");
}

}  // namespace

nb::object TaskSpecToPython(TaskSpec& spec) {
  if (spec.If<PickTaskConfig>()) return ToObject<PickTaskConfig>(spec);
  if (spec.If<PickAndPlaceTaskConfig>()) return ToObject<PickAndPlaceTaskConfig>(spec);
  return nb::cast(TaskFieldsView{spec.kind(), spec.shared_fields()});
}

TaskSpec TaskSpecFromPython(nb::handle value, const FieldPath& path) {
  if (nb::isinstance<nb::dict>(value)) return FromDict(nb::borrow<nb::dict>(value), path);
  if (const PickTaskConfig* pick = nullptr; nb::try_cast(value, pick, false) && pick) return *pick;
  if (const PickAndPlaceTaskConfig* place = nullptr; nb::try_cast(value, place, false) && place)
    return *place;
  if (const TaskFieldsView* view = nullptr; nb::try_cast(value, view, false) && view) {
    TaskSpec spec(view->kind);
    const std::vector<TaskFieldRef> from = view->fields->refs();
    const std::vector<TaskFieldRef> to = spec.fields().refs();
    // The kind may have been registered anew since.
    for (const TaskFieldRef& field : to) {
      for (const TaskFieldRef& other : from) {
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
  BindTaskConfig<PickTaskConfig>(m, "The fields of a task of kind `pick`.");
  BindTaskConfig<PickAndPlaceTaskConfig>(m, "The fields of a task of kind `pick_and_place`.");
  nb::class_<TaskFieldsView>(
      m, "TaskFields",
      "The fields of a task of one's own, as attributes: what RunConfig.task and EnvConfig.task "
      "are for kinds that were registered. Changing one changes the configuration.")
      .def_ro("kind", &TaskFieldsView::kind, "The kind of task, as in YAML.")
      .def(
          "__getattr__",
          [](nb::pointer_and_handle<TaskFieldsView> self, const std::string& name) {
            return GetField(RequireField(*self.p->fields, self.p->kind, name), self.h);
          },
          "name"_a, nb::sig("def __getattr__(self, name: str, /) -> typing.Any"))
      .def(
          "__setattr__",
          [](TaskFieldsView& view, const std::string& name, nb::handle value) {
            SetField(RequireField(*view.fields, view.kind, name), value, FieldPath(name));
          },
          "name"_a, "value"_a.none(),
          nb::sig("def __setattr__(self, name: str, value: typing.Any, /) -> None"))
      .def("__dir__",
           [](const TaskFieldsView& view) {
             std::vector<std::string> names = view.fields->names();
             names.emplace_back("kind");
             return names;
           })
      .def(
          "to_dict",
          [](nb::pointer_and_handle<TaskFieldsView> self) {
            nb::dict out;
            out["kind"] = self.p->kind;
            for (const TaskFieldRef& field : self.p->fields->refs())
              out[field.name.c_str()] = GetField(field, self.h);
            return out;
          },
          "Kind and fields as a dictionary.")
      .def(
          "__eq__",
          [](const TaskFieldsView& a, nb::handle other) -> nb::object {
            const TaskFieldsView* b = nullptr;
            if (!nb::try_cast(other, b, false) || !b) return nb::borrow(Py_NotImplemented);
            return nb::bool_(a.kind == b->kind && a.fields->Equals(*b->fields));
          },
          "other"_a.none(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__repr__",
           [](nb::pointer_and_handle<TaskFieldsView> self) { return TaskText(*self.p, self.h); });
}

}  // namespace robocell::python
