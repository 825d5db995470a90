// Fields of kinds (spec/kind_fields.h) as Python attributes: what tasks and scene sources share.
#pragma once

#include <memory>
#include <string>

#include "spec_fields.h"
#include "robocell/spec/kind_fields.h"

namespace robocell::python {

// The fields of a kind, by reference: what keeps them alive for views of their arrays.
struct KindFieldsView {
  std::string kind;
  std::shared_ptr<KindFields> fields;
};

// AttributeError with the nearest names for a field that is not there; `noun` is what messages call
// the sort of kinds.
KindFieldRef RequireKindField(KindFields& fields, const char* noun, const std::string& kind,
                              const std::string& name);
nb::object GetKindField(const KindFieldRef& field, nb::handle owner);
void SetKindField(const KindFieldRef& field, nb::handle from, const FieldPath& path);

// The kind that a dictionary names, `implied` unless it names one. NotFoundError for one that is
// not registered.
std::string KindOfDict(const KindRegistry& registry, const nb::dict& values, const FieldPath& path,
                       const std::string& implied);
// Sets the fields of the kind from a dictionary. Keys that name the kind, and `other`, are left
// out. TypeError for a name that is no field.
void SetKindFields(KindSpec& spec, const nb::dict& values, const FieldPath& path,
                   const std::string& other = "");

}  // namespace robocell::python
