#include "spec_kinds.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/spec/field_places.h"
#include "robocell/spec/scene_source_spec.h"
#include "robocell/spec/start_config.h"

namespace robocell::python {

KindFieldRef RequireKindField(KindFields& fields, const char* noun, const std::string& kind,
                              const std::string& name) {
  for (KindFieldRef& field : fields.refs()) {
    if (field.name == name) return std::move(field);
  }
  const std::string place = fmt::format("{} '{}'", noun, kind);
  const bool is_scene = noun == std::string_view(SceneSourceRegistry().noun());
  const std::string hint =
      KindKeyHint(is_scene ? "source" : "kind", name) + (is_scene ? "" : StartHint(name));
  throw nb::attribute_error((NoSuchName(place, "field", name, fields.names()) + hint).c_str());
}

nb::object GetKindField(const KindFieldRef& field, nb::handle owner) {
  return std::visit(
      [&](auto* value) -> nb::object {
        using Value = std::remove_pointer_t<decltype(value)>;
        return Convert<Value>::Get(*value, field.name.c_str(), owner);
      },
      field.value);
}

void SetKindField(const KindFieldRef& field, nb::handle from, const FieldPath& path) {
  std::visit(
      [&](auto* value) {
        using Value = std::remove_pointer_t<decltype(value)>;
        Convert<Value>::Set(*value, from, path);
      },
      field.value);
}

std::string KindOfDict(const KindRegistry& registry, const nb::dict& values, const FieldPath& path,
                       const std::string& implied) {
  const char* key = registry.key();
  if (!values.contains(key)) return implied;
  const std::string kind = ToText(values[key], FieldPath(path, key));
  if (registry.Has(kind)) return kind;
  throw NotFoundError(fmt::format("{} A {} of your own is registered before, with register_{}",
                                  fmt::format("{}.{}: ", path.text(), key) +
                                      NoSuchName("", registry.noun(), kind, registry.kinds()),
                                  registry.noun(),
                                  registry.key() == std::string("kind") ? "task" : "scene_source"));
}

void SetKindFields(KindSpec& spec, const nb::dict& values, const FieldPath& path,
                   const std::string& other) {
  const std::string key = spec.registry().key();
  for (const auto& [item, value] : values) {
    const std::string name = ToText(item, FieldPath("field name"));
    if (name == key || (!other.empty() && name == other)) continue;
    const std::vector<std::string> names = spec.fields().names();
    if (std::ranges::find(names, name) == names.end()) {
      std::vector<std::string> all = names;
      all.insert(all.begin(), key);
      if (!other.empty()) all.push_back(other);
      const std::string place = path.text() + ": " + WithArticle(spec.fields().type_name());
      throw nb::type_error(
          (NoSuchName(place, "field", name, all) + KindKeyHint(key, name) + StartHint(name))
              .c_str());
    }
    SetKindField(RequireKindField(spec.fields(), spec.registry().noun(), spec.kind(), name), value,
                 FieldPath(path, name));
  }
}

}  // namespace robocell::python
