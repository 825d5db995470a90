#include "spec_fields.h"

#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/spec/field_places.h"
#include "robocell/spec/start_config.h"

namespace robocell::python {
namespace {

std::vector<std::string> Names(const std::vector<Field>& fields) {
  std::vector<std::string> names;
  for (const Field& field : fields) names.emplace_back(field.name);
  return names;
}

const Field& FindField(const std::vector<Field>& fields, const std::string& name, const char* type,
                       const FieldPath* path) {
  for (const Field& field : fields) {
    if (name == field.name) return field;
  }
  const std::string place = (path ? path->text() + ": " : "") + WithArticle(type);
  std::string hint = PlaceHint(type, name);
  if (hint.empty()) hint = StartHint(name);
  throw nb::type_error((NoSuchName(place, "field", name, Names(fields)) + hint).c_str());
}

// Returns the only entry of {kind: value}.
std::pair<std::string, nb::object> OnlyEntry(nb::handle value, const FieldPath& path,
                                             const std::string& example) {
  const nb::dict dict = nb::borrow<nb::dict>(value);
  if (dict.size() != 1) ThrowValue(path, "must have one entry, as in " + example);
  const auto [key, item] = *dict.begin();
  return {ToText(key, path), nb::borrow(item)};
}

}  // namespace

void AddField(std::vector<Field>* fields, const char* name, const char* doc, const void* spec,
              const void* value, const FieldOps& ops) {
  const auto offset =
      static_cast<size_t>(static_cast<const char*>(value) - static_cast<const char*>(spec));
  fields->push_back({name, doc, ops.type(), ops.set_type(), offset, &ops});
}

bool HoldsOthers(const std::vector<Field>& fields, nb::handle dict) {
  for (const auto& [key, value] : nb::borrow<nb::dict>(dict)) {
    const bool whole = nb::isinstance<nb::dict>(value) ||
                       (nb::isinstance<nb::tuple>(value) && nb::len(value) == 2);
    if (!whole || !IsText(key)) return false;
    const std::string name = ToText(key, FieldPath("field name"));
    for (const Field& field : fields) {
      if (name == field.name) return false;
    }
  }
  return nb::len(dict) > 0;
}

void SetFields(const std::vector<Field>& fields, void* spec, const char* type, nb::handle values,
               const FieldPath* path) {
  for (const auto& [key, value] : nb::borrow<nb::dict>(values)) {
    const std::string name = ToText(key, FieldPath("field name"));
    const Field& field = FindField(fields, name, type, path);
    field.set(spec, value, path ? FieldPath(*path, name) : FieldPath(name));
  }
}

AttachTarget ToAttachTarget(nb::handle value, const FieldPath& path) {
  AttachTarget out;
  if (const AttachTarget* target = nullptr; nb::try_cast(value, target) && target) return *target;
  if (nb::isinstance<nb::dict>(value)) {
    const auto [kind, name] = OnlyEntry(value, path, "{'site': 'flange'}");
    Convert<AttachKind>::Set(out.kind, Text(kind), path);
    out.name = ToText(name, path);
  } else if (IsText(value)) {
    Convert<AttachKind>::Set(out.kind, value, path);
  } else {
    ThrowType(path, "an AttachTarget", value);
  }
  return out;
}

ElementRef ToElementRef(nb::handle value, const FieldPath& path) {
  if (const ElementRef* ref = nullptr; nb::try_cast(value, ref) && ref) return *ref;
  if (IsText(value)) return {.name = ToText(value, path)};
  if (!nb::isinstance<nb::dict>(value)) ThrowType(path, "an ElementRef", value);
  ElementRef out;
  nb::object place = nb::borrow(value);
  if (!nb::borrow<nb::dict>(value).contains("index")) {
    const auto [kind, item] = OnlyEntry(value, path, "{'site': 'tcp'}");
    Convert<ElementKind>::Set(out.kind.emplace(), Text(kind), path);
    if (IsText(item)) return out.name = ToText(item, path), out;
    place = item;
  }
  if (!nb::isinstance<nb::dict>(place))
    ThrowType(path, "a name or {'body': name, 'index': 0}", place);
  for (const auto& [key, item] : nb::borrow<nb::dict>(place)) {
    const std::string name = ToText(key, path);
    if (name == "body") {
      out.body = ToText(item, FieldPath(path, name));
    } else if (name == "index") {
      out.index = static_cast<int>(ToInt(item, FieldPath(path, name), 0, INT32_MAX));
    } else {
      ThrowValue(path, NoSuchName("", "key", name, {"body", "index"}));
    }
  }
  return out;
}

}  // namespace robocell::python
