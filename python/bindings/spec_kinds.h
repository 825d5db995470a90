// Fields of kinds (spec/kind_fields.h) as Python attributes: the common part of tasks and scene
// sources.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "spec_fields.h"
#include "robocell/spec/kind_fields.h"
#include "robocell/spec/task_spec.h"

namespace robocell::python {

// Refers to the fields of a kind, and keeps them alive for views of their arrays.
struct KindFieldsView {
  std::string kind;
  std::shared_ptr<KindFields> fields;
};

// Raises AttributeError with the nearest names for an unknown field; `noun` is the word for the
// sort of kinds in messages.
KindFieldRef RequireKindField(KindFields& fields, const char* noun, const std::string& kind,
                              const std::string& name);
nb::object GetKindField(const KindFieldRef& field, nb::handle owner);
void SetKindField(const KindFieldRef& field, nb::handle from, const FieldPath& path);

// Returns the kind that a dictionary names, by default `implied`. Throws NotFoundError for one that
// is not registered.
std::string KindOfDict(const KindRegistry& registry, const nb::dict& values, const FieldPath& path,
                       const std::string& implied);
// Sets the fields of the kind from a dictionary. Skips keys that name the kind, and `other`. Raises
// TypeError for a name that is not a field.
void SetKindFields(KindSpec& spec, const nb::dict& values, const FieldPath& path,
                   const std::string& other = "");

// A kind of task whose fields are a Python class of their own; others are TaskFields.
struct TaskClass {
  std::string name;
  nb::object (*to_python)(TaskSpec& spec);                   // null for another kind
  std::optional<TaskSpec> (*from_python)(nb::handle value);  // unset for another class
};
// Makes the class known to all fields `task`. Comes before the classes that have such a field.
void AddTaskClass(TaskClass added);

}  // namespace robocell::python
