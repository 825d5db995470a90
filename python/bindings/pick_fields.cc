// The fields of the built-in kinds of tasks as Python classes.
#include <memory>
#include <optional>

#include "spec_class.h"
#include "spec_kinds.h"
#include "spec_parts.h"
#include "robocell/task/held_task_config.h"
#include "robocell/task/navigate_task_config.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/relation_task_config.h"
#include "robocell/task/two_arm_task_config.h"

namespace robocell::python {

namespace {

// The object refers to the fields of the configuration.
template <NamesItsKind T>
nb::object FieldsToPython(TaskSpec& spec) {
  T* fields = spec.If<T>();
  return fields ? nb::cast(std::shared_ptr<T>(spec.shared_fields(), fields)) : nb::object();
}

template <NamesItsKind T>
std::optional<TaskSpec> FieldsFromPython(nb::handle value) {
  const T* fields = nullptr;
  if (!nb::try_cast(value, fields, false) || !fields) return std::nullopt;
  return TaskSpec(*fields);
}

template <NamesItsKind T>
void BindFields(nb::module_& m, const char* doc) {
  BindSpecClass<T>(m, doc).def_prop_ro(
      "kind", [](const T&) { return std::string(T::kKind); }, "The kind of task, as in YAML.");
  AddTaskClass({T::kTypeName, &FieldsToPython<T>, &FieldsFromPython<T>});
}

}  // namespace

void BindPickSpecs(nb::module_& m) {
  BindFields<PickTaskConfig>(
      m,
      "The fields of a task of kind `pick`."
      "\n\nExamples:\n"
      "    >>> run.task = rc.tasks.PickTaskConfig(objects=[\"box\", \"nut\"])");
  BindFields<PickAndPlaceTaskConfig>(m, "The fields of a task of kind `pick_and_place`.");
  BindFields<RelationsTaskConfig>(
      m,
      "The fields of a task of kind `relations`, whose start and goal are sentences."
      "\n\nExamples:\n"
      "    >>> run.task = rc.tasks.RelationsTaskConfig(objects=[\"mug\", \"tray\"], "
      "goal=[\"mug on tray\"])");
  BindFields<StackTaskConfig>(m, "The fields of a task of kind `stack`.");
  BindFields<PlaceNextToTaskConfig>(m, "The fields of a task of kind `place_next_to`.");
  BindFields<OpenTaskConfig>(m, "The fields of a task of kind `open`.");
  BindFields<CloseTaskConfig>(m, "The fields of a task of kind `close`.");
  BindFields<PressTaskConfig>(m, "The fields of a task of kind `press`.");
  BindFields<PushTaskConfig>(m, "The fields of a task of kind `push`.");
  BindFields<InsertTaskConfig>(m, "The fields of a task of kind `insert`.");
  BindFields<SortTaskConfig>(m, "The fields of a task of kind `sort`.");
  BindFields<WipeTaskConfig>(m, "The fields of a task of kind `wipe`.");
  BindFields<PourTaskConfig>(m, "The fields of a task of kind `pour`.");
  BindFields<HandoverTaskConfig>(m, "The fields of a task of kind `handover`.");
  BindFields<CarryTaskConfig>(m, "The fields of a task of kind `carry`.");
  BindFields<NavigateTaskConfig>(m, "The fields of a task of kind `navigate`.");
}

}  // namespace robocell::python
