// The specs' value types. Their enums are in spec_enums.cc; the spec classes are in spec_robot.cc,
// spec_scene.cc, spec_run.cc and spec_env.cc.
#include <nanobind/operators.h>

#include "bindings.h"
#include "spec_class.h"
#include "spec_enums.h"
#include "spec_parts.h"
#include "robocell/base/error.h"
#include "robocell/spec/spec_file.h"

namespace robocell::python {
namespace {

void BindAttachTarget(nb::module_& m) {
  nb::class_<AttachTarget>(
      m, "AttachTarget",
      "The target of an attachment, immutable: AttachTarget(AttachKind.Site, "
      "'pinch_site').\n\nWorld, Root and SharedBase are frames and have no name."
      "\n\nExamples:\n"
      "    >>> rc.robots.AttachTarget(\"body\", \"link7\")\n"
      "    AttachTarget(AttachKind.Body, 'link7')")
      .def(
          "__init__",
          [](AttachTarget* self, nb::handle kind, const std::string& name) {
            AttachTarget target{.name = name};
            Convert<AttachKind>::Set(target.kind, kind, FieldPath("kind"));
            new (self) AttachTarget(std::move(target));
          },
          nb::arg("kind") = AttachKind::kWorld, nb::arg("name") = "",
          nb::sig("def __init__(self, kind: AttachKind | str = ..., name: str = '') "
                  "-> None"))
      .def_ro("kind", &AttachTarget::kind, "Kind of the target.")
      .def_ro("name", &AttachTarget::name, "Name of the target; '' for the frames.")
      .def(nb::self == nb::self)
      .def("__hash__",
           [](const AttachTarget& t) {
             return nb::hash(nb::make_tuple(static_cast<int>(t.kind), Text(t.name)));
           })
      .def("__repr__",
           [](const AttachTarget& t) {
             const std::string kind = "AttachKind." + CamelCase(ToString(t.kind));
             if (t.name.empty()) return fmt::format("AttachTarget({})", kind);
             return fmt::format("AttachTarget({}, {})", kind, nb::repr(Text(t.name)).c_str());
           })
      .def(
          "__getstate__",
          [](const AttachTarget& t) {
            return std::make_pair(std::string(ToString(t.kind)), t.name);
          },
          nb::sig("def __getstate__(self) -> tuple[str, str]"))
      .def(
          "__setstate__",
          [](AttachTarget& self, const std::pair<std::string, std::string>& state) {
            AttachTarget target{.name = state.second};
            Convert<AttachKind>::Set(target.kind, Text(state.first), FieldPath("kind"));
            new (&self) AttachTarget(std::move(target));
          },
          nb::sig("def __setstate__(self, state: tuple[str, str]) -> None"));
}

nb::tuple StateOf(const ElementRef& ref) {
  const nb::object kind = ref.kind ? nb::object(Text(ToString(*ref.kind))) : nb::none();
  return nb::make_tuple(Text(ref.name), kind, Text(ref.body), ref.index);
}

ElementRef MakeElementRef(nb::handle name, nb::handle kind, nb::handle body, nb::handle index) {
  ElementRef ref{.name = ToText(name, FieldPath("name")), .body = ToText(body, FieldPath("body"))};
  Convert<std::optional<ElementKind>>::Set(ref.kind, kind, FieldPath("kind"));
  ref.index = static_cast<int>(ToInt(index, FieldPath("index"), 0, INT32_MAX));
  return ref;
}

void BindElementRef(nb::module_& m) {
  nb::class_<ElementRef>(
      m, "ElementRef",
      "Refers to an element of a model, immutable: by name, or the index-th of its kind in a "
      "body.\n\n    ElementRef('link_tcp', kind=ElementKind.SITE)\n    "
      "ElementRef(kind=ElementKind.GEOM, body='left_finger', index=3)")
      .def(
          "__init__",
          [](ElementRef* self, nb::handle name, nb::handle kind, nb::handle body,
             nb::handle index) { new (self) ElementRef(MakeElementRef(name, kind, body, index)); },
          nb::arg("name") = "", nb::kw_only(), nb::arg("kind") = nb::none(), nb::arg("body") = "",
          nb::arg("index") = 0,
          nb::sig("def __init__(self, name: str = '', *, kind: ElementKind | str | None = None, "
                  "body: str = '', index: int = 0) -> None"))
      .def_ro("kind", &ElementRef::kind,
              "Kind of the element. Unset: any kind that the field allows.")
      .def_ro("name", &ElementRef::name, "Name of the element; '' for an unnamed one.")
      .def_ro("body", &ElementRef::body, "The body of an unnamed element.")
      .def_ro("index", &ElementRef::index,
              "Number of the element among those of this kind in that body, from 0.")
      .def(nb::self == nb::self)
      .def("__hash__", [](const ElementRef& ref) { return nb::hash(StateOf(ref)); })
      .def("__repr__",
           [](const ElementRef& ref) {
             const std::string kind =
                 ref.kind ? ", kind=ElementKind." + UpperCase(ToString(*ref.kind)) : "";
             if (ref.body.empty()) {
               return fmt::format("ElementRef({}{})", nb::repr(Text(ref.name)).c_str(), kind);
             }
             return fmt::format("ElementRef(body={}, index={}{})", nb::repr(Text(ref.body)).c_str(),
                                ref.index, kind);
           })
      .def("__getstate__", &StateOf, nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__",
          [](ElementRef& self, nb::tuple state) {
            new (&self) ElementRef(MakeElementRef(state[0], state[1], state[2], state[3]));
          },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...]) -> None"));
}

}  // namespace

void BindSpec(nb::module_& m) {
  BindEnums(m);
  BindAttachTarget(m);
  BindElementRef(m);
  BindSpecContainers(m);
  BindRobotSpecs(m);
  BindSceneSpecs(m);
  BindPickSpecs(m);
  BindTaskSpecs(m);
  BindSceneSourceSpecs(m);
  BindRandomizeSpecs(m);
  BindRunSpecs(m);
  BindEnvSpecs(m);
  m.def("missing_spec_file", &MissingSpecFile, nb::arg("path"), nb::arg("type"),
        "Explains a missing spec file, with the entries beside it; '' if it is a file.");
  m.def("scene_object_element_name", &SceneObjectElementName, nb::arg("object"), nb::arg("element"),
        "Returns the full name of an element of a model object, without a scene: ('table', "
        "'table_top') -> 'table_table_top'.");
  m.def(
      "expand_names",
      [](const std::string& text) { return ToTuple(NameList::Expand(text).names, Text); },
      nb::arg("text"), nb::sig("def expand_names(text: str) -> tuple[str, ...]"),
      "Expands 'joint1..joint7' to names; a name without '..' stays.");
}

}  // namespace robocell::python
