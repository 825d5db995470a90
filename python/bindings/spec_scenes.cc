// The `scenes` of a run: the kind of source, the selected scenes, and the fields of that kind.
#include "spec_class.h"
#include "spec_kinds.h"
#include "spec_parts.h"
#include "robocell/spec/scene_source_spec.h"

namespace robocell::python {

using namespace nb::literals;

namespace {

constexpr const char* kHouses = "houses";

SceneSourceSpec ScenesOfDict(const nb::dict& values, const FieldPath& path) {
  const char* implied = values.contains("files") ? FilesScenes::kKind : TabletopScenes::kKind;
  SceneSourceSpec spec(KindOfDict(SceneSourceRegistry(), values, path, implied));
  SetKindFields(spec, values, path, kHouses);
  if (values.contains(kHouses))
    Convert<IndexList>::Set(spec.houses, values[kHouses], FieldPath(path, kHouses));
  return spec;
}

// Keeps views of the fields alive when the spec gets another kind.
nb::object OwnerOf(SceneSourceSpec& spec) {
  return nb::cast(KindFieldsView{spec.kind(), spec.shared_fields()});
}

nb::dict ToDict(SceneSourceSpec& spec) {
  nb::dict out;
  out["source"] = spec.kind();
  if (!spec.houses.empty()) out[kHouses] = Convert<IndexList>::Get(spec.houses, kHouses, {});
  const nb::object owner = OwnerOf(spec);
  for (const KindFieldRef& field : spec.fields().refs())
    out[field.name.c_str()] = GetKindField(field, owner);
  return out;
}

std::string ScenesText(SceneSourceSpec& spec) {
  std::string text;
  for (const auto& [name, value] : ToDict(spec))
    text += (text.empty() ? "" : ", ") + std::string(nb::str(name).c_str()) + "=" +
            nb::repr(value).c_str();
  return "SceneSourceSpec(" + text + ")";
}

}  // namespace

SceneSourceSpec ScenesFromPython(nb::handle value, const FieldPath& path) {
  if (nb::isinstance<nb::dict>(value)) return ScenesOfDict(nb::borrow<nb::dict>(value), path);
  if (const SceneSourceSpec* spec = nullptr; nb::try_cast(value, spec, false) && spec) return *spec;
  ThrowType(path, "the fields of a scene source, for example {'source': 'tabletop'}", value);
}

void BindSceneSourceSpecs(nb::module_& m) {
  BindSpecClass<FilesScenes>(m, "The fields of a scene source of kind `files`.");
  nb::class_<SceneSourceSpec>(m, "SceneSourceSpec",
                              "The source of a run's scenes: `source`, the kind; `houses`, the "
                              "numbers of its scenes; and the fields of that kind as attributes.")
      .def(
          "__init__",
          [](SceneSourceSpec* self, const nb::kwargs& fields) {
            new (self) SceneSourceSpec(ScenesOfDict(fields, FieldPath("SceneSourceSpec")));
          },
          nb::sig("def __init__(self, *, source: str = 'tabletop', houses: "
                  "collections.abc.Iterable[int] = (), **fields: typing.Any) -> None"))
      .def_prop_rw(
          "source", [](const SceneSourceSpec& spec) { return spec.kind(); },
          [](SceneSourceSpec& spec, const std::string& kind) { spec.SetKind(kind); },
          "The kind of source. A new kind starts with its defaults.")
      .def_prop_rw(
          kHouses,
          [](SceneSourceSpec& spec) { return Convert<IndexList>::Get(spec.houses, kHouses, {}); },
          [](SceneSourceSpec& spec, nb::handle value) {
            Convert<IndexList>::Set(spec.houses, value, FieldPath(kHouses));
          },
          SceneSourceSpec::kHousesDoc,
          nb::for_getter(nb::sig("def houses(self, /) -> tuple[int, ...]")),
          nb::for_setter(
              nb::sig("def houses(self, value: collections.abc.Iterable[int], /) -> None")))
      .def(
          "__getattr__",
          [](SceneSourceSpec& spec, const std::string& name) {
            return GetKindField(RequireKindField(spec.fields(), "scene source", spec.kind(), name),
                                OwnerOf(spec));
          },
          "name"_a, nb::sig("def __getattr__(self, name: str, /) -> typing.Any"))
      .def(
          "__setattr__",
          [](SceneSourceSpec& spec, const std::string& name, nb::handle value) {
            if (name == "source") return spec.SetKind(ToText(value, FieldPath(name)));
            if (name == kHouses)
              return Convert<IndexList>::Set(spec.houses, value, FieldPath(name));
            SetKindField(RequireKindField(spec.fields(), "scene source", spec.kind(), name), value,
                         FieldPath(name));
          },
          "name"_a, "value"_a.none(),
          nb::sig("def __setattr__(self, name: str, value: typing.Any, /) -> None"))
      .def("__dir__",
           [](const SceneSourceSpec& spec) {
             std::vector<std::string> names = spec.fields().names();
             names.insert(names.end(), {"source", kHouses, "to_dict"});
             return names;
           })
      .def("to_dict", &ToDict, "Returns kind, selected scenes and fields of the kind.")
      .def(
          "__eq__",
          [](const SceneSourceSpec& a, nb::handle other) -> nb::object {
            const SceneSourceSpec* b = nullptr;
            if (!nb::try_cast(other, b, false) || !b) return nb::borrow(Py_NotImplemented);
            return nb::bool_(a == *b);
          },
          "other"_a.none(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__repr__", &ScenesText)
      .attr("__hash__") = nb::none();
}

}  // namespace robocell::python
