// A spec struct as a Python class: keyword constructor, fields by reference, equality, copies,
// pickling, repr, YAML, and garbage collection that traverses the Python objects in a spec.
// Included by spec*.cc only.
#pragma once

#include <filesystem>
#include <new>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "spec_fields.h"
#include "robocell/spec/yaml.h"

namespace robocell::python {

// --- Garbage collection --------------------------------------------------------------------------
//
// A spec made in Python owns its boxes. A box whose deleter is nanobind's holds a reference to a
// Python object, which is visited. A box made in C++ is traversed if it has no other owner; if a
// Python object holds it too, its content counts as referenced from outside and stays. Objects that
// only refer to a spec inside another one own nothing and visit nothing.

template <HasFields T, class F>
void ForEachBox(T& spec, F&& f);

template <class T, class F>
void VisitBoxes(T& value, F&& f) {
  if constexpr (IsList<T>::value) {
    for (auto& box : value.boxes()) f(box);
  } else if constexpr (IsMap<T>::value) {
    if constexpr (HasFields<typename T::mapped_type>) {
      for (auto& [key, box] : value.entries()) f(box);
    } else if constexpr (IsMap<typename T::mapped_type>::value) {
      for (auto& [key, box] : value.entries()) {
        if (box.use_count() == 1) VisitBoxes(*box, f);
      }
    }
  } else if constexpr (requires { value.box(); }) {
    if (value) f(value.box());
  } else if constexpr (std::is_same_v<T, RobotSource>) {
    ForEachBox(value.config, f);
  } else if constexpr (HasFields<T>) {
    ForEachBox(value, f);
  }
}

template <HasFields T, class F>
void ForEachBox(T& spec, F&& f) {
  ForEachField(spec, [&](const char*, auto& value, const char*, Bound) { VisitBoxes(value, f); });
}

template <HasFields T>
int TraverseBoxes(T& spec, visitproc visit, void* arg) {
  int result = 0;
  ForEachBox(spec, [&](auto& box) {
    if (result != 0) return;
    if (auto* deleter = std::get_deleter<nb::detail::py_deleter>(box)) {
      result = visit(deleter->o, arg);
    } else if (box.use_count() == 1) {
      result = TraverseBoxes(*box, visit, arg);
    }
  });
  return result;
}

// Returns the spec that a Python object owns; null for one under construction or one that only
// refers.
template <class T>
T* Owned(PyObject* self) {
  const auto [ready, owns] = nb::inst_state(self);
  return ready && owns ? nb::inst_ptr<T>(self) : nullptr;
}

template <HasFields T>
int TraverseSpec(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  T* spec = Owned<T>(self);
  return spec ? TraverseBoxes(*spec, visit, arg) : 0;
}

template <HasFields T>
int ClearSpec(PyObject* self) {
  if (T* spec = Owned<T>(self)) {
    T doomed{};
    std::swap(doomed, *spec);
  }
  return 0;
}

template <HasFields T>
PyType_Slot kSpecSlots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&TraverseSpec<T>)},
                            {Py_tp_clear, reinterpret_cast<void*>(&ClearSpec<T>)},
                            {0, nullptr}};

// --- The class -----------------------------------------------------------------------------------

// Returns "def __init__(self, *, name: str = ..., ...) -> None".
std::string InitSignature(const std::vector<Field>& fields);
// Returns "RobotSpec(path='arm.xml', prefix='left_')": the fields that differ from the default.
std::string ReprOf(const std::vector<Field>& fields, const char* type, void* spec,
                   const void* plain, nb::handle self);
// Returns a new object of the same Python class, without its value.
nb::object AllocateLike(nb::handle self);
// Copies the attributes that a Python subclass added.
void CopyAttributes(nb::handle from, nb::handle to);

template <HasFields T>
nb::object CopySpec(nb::handle self) {
  nb::object copy = AllocateLike(self);
  new (nb::inst_ptr<T>(copy)) T(*nb::inst_ptr<T>(self));
  nb::inst_mark_ready(copy);
  CopyAttributes(self, copy);
  return copy;
}

template <HasFields T>
void DefFields(nb::class_<T>& c) {
  for (const Field& field : FieldsOf<T>()) {
    const Field* f = &field;
    c.def_prop_rw(
        f->name, [f](nb::pointer_and_handle<T> self) { return f->get(self.p, self.h); },
        [f](T& self, nb::handle value) { f->set(&self, value, FieldPath(f->name)); }, f->doc,
        nb::for_getter(nb::sig(KeepText(fmt::format("def {}(self, /) -> {}", f->name, f->type)))),
        nb::for_setter(nb::arg("value").none()),
        nb::for_setter(nb::sig(
            KeepText(fmt::format("def {}(self, value: {}, /) -> None", f->name, f->set_type)))));
  }
}

// Calls f(std::string&) with the folder of the spec's file, and with those of the specs in it.
template <class T, class F>
void ForEachSourceDir(T& value, F&& f) {
  if constexpr (requires { value.source_dir; }) f(value.source_dir);
  if constexpr (IsList<T>::value) {
    for (auto& item : value) ForEachSourceDir(item, f);
  } else if constexpr (IsMap<T>::value) {
    for (auto& [key, box] : value.entries()) ForEachSourceDir(*box, f);
  } else if constexpr (IsOptional<T>::value) {
    if (value) ForEachSourceDir(*value, f);
  } else if constexpr (std::is_same_v<T, RobotSource>) {
    ForEachSourceDir(value.config, f);
  } else if constexpr (HasFields<T>) {
    ForEachField(value,
                 [&](const char*, auto& field, const char*, Bound) { ForEachSourceDir(field, f); });
  }
}

// True if relative paths start at the working folder when the spec has no folder. Those of a robot
// without a folder start at the folder of the spec that contains the robot.
template <class T>
constexpr bool kOwnsPaths = requires(T& value) {
  value.source_dir;
}
&&!std::is_same_v<T, RobotConfig>;

// Returns the working folder for "".
inline std::string AbsoluteFolder(const std::string& folder) {
  return std::filesystem::absolute(folder.empty() ? "." : folder).lexically_normal().string();
}

// Pickles the spec as YAML, with the folders of its files.
template <HasFields T>
void DefCopies(nb::class_<T>& c) {
  c.def(
      "__copy__", [](nb::handle_t<T> self) { return CopySpec<T>(self); },
      nb::sig("def __copy__(self) -> typing.Self"));
  c.def(
      "__deepcopy__", [](nb::handle_t<T> self, nb::handle) { return CopySpec<T>(self); },
      nb::sig("def __deepcopy__(self, memo: typing.Any, /) -> typing.Self"));
  c.def(
      "__getstate__",
      [](T& self) {
        std::vector<std::string> state = {ToYaml(self)};
        // The reader may work in another folder.
        ForEachSourceDir(self, [&](const std::string& folder) {
          const bool owner = kOwnsPaths<T> && state.size() == 1;
          state.push_back(folder.empty() && !owner ? "" : AbsoluteFolder(folder));
        });
        return state;
      },
      nb::sig("def __getstate__(self) -> list[str]"));
  c.def(
      "__setstate__",
      [](T& self, const std::vector<std::string>& state) {
        T value = FromYamlUnchecked<T>(state.at(0));
        size_t next = 1;
        ForEachSourceDir(value, [&](std::string& folder) { folder = state.at(next++); });
        new (&self) T(std::move(value));
      },
      nb::sig("def __setstate__(self, state: list[str]) -> None"));
}

template <HasFields T>
void DefYaml(nb::class_<T>& c) {
  c.def(
      "to_yaml", [](const T& self) { return ToYaml(self); },
      "Returns YAML text that from_yaml reads back to an equal spec; unset fields are omitted. "
      "Relative paths stay relative: pass their folder to from_yaml as `directory`. Pickling keeps "
      "the folder.");
  c.def(
      "validate",
      [](const T& self, const std::string& what) {
        RequireValid(self, what.empty() ? T::kTypeName : what);
      },
      nb::arg("what") = "",
      "Validates all fields. Raises SpecError with all problems; `what` names the spec in the "
      "message.");
}

// Adds load, from_yaml and location, for specs with their own files.
template <HasFields T>
void DefYamlFile(nb::class_<T>& c) {
  using Path = std::filesystem::path;
  c.def_static(
      "load",
      [](const Path& path, const std::vector<std::string>& overrides) {
        return LoadYaml<T>(path.string(), overrides);
      },
      nb::arg("path"), nb::arg("overrides") = nb::list(), nb::call_guard<nb::gil_scoped_release>(),
      nb::sig(KeepText(fmt::format("def load(path: str | os.PathLike[str], overrides: "
                                   "collections.abc.Sequence[str] = ()) -> {}",
                                   T::kTypeName))),
      "Reads a YAML file; `overrides` replace single fields first, as in "
      "'task.lift_height=0.05'.\n\n"
      "Raises SpecError with all problems (file:line:column), IoError if the file cannot be read.");
  c.def_static(
      "from_yaml",
      [](const std::string& text, const std::string& source, const Path& directory,
         const std::vector<std::string>& overrides) {
        return ParseYaml<T>(text, source, directory.string(), overrides);
      },
      nb::arg("text"), nb::arg("source") = "yaml", nb::arg("directory") = "",
      nb::arg("overrides") = nb::list(),
      nb::sig(
          KeepText(fmt::format("def from_yaml(text: str, source: str = 'yaml', directory: str | "
                               "os.PathLike[str] = '', overrides: collections.abc.Sequence[str] = "
                               "()) -> {}",
                               T::kTypeName))),
      "Reads YAML text; messages use `source` as the file name, relative paths start at "
      "`directory`; `overrides` as in load.");
  if constexpr (requires(const T& spec) { spec.locations; }) {
    c.def(
        "location",
        [](const T& self, const std::string& field) { return self.locations.At(field); },
        nb::arg("field") = "",
        "Returns the position of a field in its file, for messages: location('output') is "
        "'run.yaml:3:9'.\n\n"
        "Fields of parts are written as in 'cameras.streams[0].camera'. Returns the position of "
        "the parent for a field that the file does not set, '--set output=/tmp/x' for an override, "
        "and '' without a file.");
  }
}

template <HasFields T>
nb::class_<T> BindSpecClass(nb::module_& m, const char* doc) {
  nb::class_<T> c(m, T::kTypeName, doc, nb::type_slots(kSpecSlots<T>), nb::is_weak_referenceable());
  c.def(
      "__init__",
      [](T* self, nb::kwargs fields) {
        T value{};
        SetFields(FieldsOf<T>(), &value, T::kTypeName, fields, nullptr);
        new (self) T(std::move(value));
      },
      nb::sig(KeepText(InitSignature(FieldsOf<T>()))));
  DefFields(c);
  c.def(
      "__eq__",
      [](const T& a, nb::handle b) {
        const T* other = nullptr;
        return nb::try_cast(b, other) && other && a == *other;
      },
      nb::arg("other").none(), nb::sig("def __eq__(self, other: object, /) -> bool"));
  c.attr("__hash__") = nb::none();
  c.def("__repr__", [](nb::pointer_and_handle<T> self) {
    const T plain{};
    return ReprOf(FieldsOf<T>(), T::kTypeName, self.p, &plain, self.h);
  });
  DefCopies(c);
  DefYaml(c);
  return c;
}

}  // namespace robocell::python
