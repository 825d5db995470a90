#include "spec_containers.h"

#include <algorithm>

#include <fmt/format.h>
#include <nanobind/typing.h>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell::python {
namespace {

// --- List ----------------------------------------------------------------------------------------

void* ListOf(const SpecList& self) {
  if (!self.list) throw ClosedError(self.name + ": the spec this list belongs to is gone");
  return self.list;
}

size_t Size(const SpecList& self) { return self.ops->size(ListOf(self)); }

nb::object Get(const SpecList& self, size_t i) { return self.ops->get(ListOf(self), i); }

size_t Index(const SpecList& self, Py_ssize_t i) {
  const auto size = static_cast<Py_ssize_t>(Size(self));
  const Py_ssize_t at = i < 0 ? i + size : i;
  if (at < 0 || at >= size) {
    throw nb::index_error(fmt::format("{}[{}] is out of range, it has {}", self.name, i,
                                      Counted(static_cast<int64_t>(size), "element"))
                              .c_str());
  }
  return static_cast<size_t>(at);
}

AnyBox ToBox(const SpecList& self, nb::handle value, size_t i) {
  const FieldPath list(self.name);
  return self.ops->box(value, FieldPath(list, static_cast<Py_ssize_t>(i)));
}

std::vector<AnyBox> ToBoxes(const ListOps& ops, nb::handle value, const FieldPath& path) {
  std::vector<AnyBox> boxes;
  const std::string expected = fmt::format("a list of {}", ops.element);
  for (const nb::object& item : ToItems(value, path, expected)) {
    boxes.push_back(ops.box(item, FieldPath(path, static_cast<Py_ssize_t>(boxes.size()))));
  }
  return boxes;
}

void Append(SpecList& self, nb::handle value) {
  const size_t n = Size(self);
  self.ops->splice(ListOf(self), n, 0, {ToBox(self, value, n)});
}

void Insert(SpecList& self, Py_ssize_t i, nb::handle value) {
  const auto n = static_cast<Py_ssize_t>(Size(self));
  const Py_ssize_t at = std::clamp<Py_ssize_t>(i < 0 ? i + n : i, 0, n);
  self.ops->splice(ListOf(self), at, 0, {ToBox(self, value, at)});
}

void Extend(SpecList& self, nb::handle values) {
  const FieldPath path(self.name);
  const std::vector<AnyBox> boxes = ToBoxes(*self.ops, values, path);
  self.ops->splice(ListOf(self), Size(self), 0, boxes);
}

nb::object Pop(SpecList& self, Py_ssize_t i) {
  const size_t at = Index(self, i);
  nb::object out = Get(self, at);
  self.ops->splice(ListOf(self), at, 1, {});
  return out;
}

// Returns the objects as a Python list, for slices and searches.
nb::list Objects(const SpecList& self) {
  nb::list out;
  for (size_t i = 0; i < Size(self); ++i) out.append(Get(self, i));
  return out;
}

nb::object GetItem(const SpecList& self, Py_ssize_t i) { return Get(self, Index(self, i)); }

nb::object GetSlice(const SpecList& self, nb::slice slice) {
  return nb::object(Objects(self))[slice];
}

void AssignObjects(SpecList& self, nb::handle objects) {
  const FieldPath path(self.name);
  AssignList(ListOf(self), *self.ops, objects, path);
}

// Edits a Python list of the objects, then adopts it.
template <class F>
void Rewrite(SpecList& self, F&& edit) {
  nb::object objects = Objects(self);
  edit(objects);
  AssignObjects(self, objects);
}

void SetItem(SpecList& self, Py_ssize_t i, nb::handle value) {
  const size_t at = Index(self, i);
  self.ops->splice(ListOf(self), at, 1, {ToBox(self, value, at)});
}

void SetSlice(SpecList& self, nb::slice slice, nb::handle values) {
  const FieldPath path(self.name);
  ToBoxes(*self.ops, values, path);  // rejects wrong elements by their own index
  Rewrite(self, [&](nb::object& objects) { objects[slice] = values; });
}

void DelItem(SpecList& self, Py_ssize_t i) {
  self.ops->splice(ListOf(self), Index(self, i), 1, {});
}

void DelSlice(SpecList& self, nb::slice slice) {
  Rewrite(self, [&](nb::object& objects) { nb::del(objects[slice]); });
}

// Compares by identity first, then by equality, like Python's list.
Py_ssize_t Find(const SpecList& self, nb::handle value) {
  const nb::list objects = Objects(self);
  for (size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].is(value) || nb::object(objects[i]).equal(value)) {
      return static_cast<Py_ssize_t>(i);
    }
  }
  return -1;
}

size_t FindOrThrow(const SpecList& self, nb::handle value) {
  const Py_ssize_t at = Find(self, value);
  if (at < 0) {
    throw nb::value_error(
        fmt::format("{} does not hold that {}", self.name, self.ops->element).c_str());
  }
  return static_cast<size_t>(at);
}

bool Equal(const SpecList& self, nb::handle other) {
  if (const SpecList* list = nullptr; nb::try_cast(other, list) && list) {
    return self.ops == list->ops && self.ops->equal(ListOf(self), ListOf(*list));
  }
  return nb::isinstance<nb::list>(other) && Objects(self).equal(other);
}

// --- Map -----------------------------------------------------------------------------------------

void* MapOf(const SpecMap& self) {
  if (!self.map) throw ClosedError(self.name + ": the spec this mapping belongs to is gone");
  return self.map;
}

size_t Size(const SpecMap& self) { return self.ops->size(MapOf(self)); }

std::vector<std::string> Keys(const SpecMap& self) {
  std::vector<std::string> keys;
  for (size_t i = 0; i < Size(self); ++i) keys.push_back(self.ops->key(MapOf(self), i));
  return keys;
}

Py_ssize_t Find(const SpecMap& self, nb::handle key) {
  if (!IsText(key)) return -1;
  const std::vector<std::string> keys = Keys(self);
  const auto at = std::find(keys.begin(), keys.end(), ToText(key, FieldPath(self.name)));
  return at == keys.end() ? -1 : at - keys.begin();
}

size_t FindOrThrow(const SpecMap& self, nb::handle key) {
  const Py_ssize_t at = Find(self, key);
  if (at >= 0) return static_cast<size_t>(at);
  const std::string name = IsText(key) ? ToText(key, FieldPath(self.name)) : TypeName(key);
  throw nb::key_error(NoSuchName(self.name, "key", name, Keys(self)).c_str());
}

nb::object GetItem(const SpecMap& self, nb::handle key) {
  return self.ops->get(MapOf(self), FindOrThrow(self, key), self.name);
}

void SetItem(SpecMap& self, nb::handle key, nb::handle value) {
  const FieldPath path(self.name);
  const std::string name = ToKey(key, path);
  self.ops->set(MapOf(self), name, self.ops->box(value, FieldPath(path, name)));
}

void DelItem(SpecMap& self, nb::handle key) {
  self.ops->erase(MapOf(self), FindOrThrow(self, key));
}

nb::object Pop(SpecMap& self, nb::handle key, nb::args otherwise) {
  const Py_ssize_t at = Find(self, key);
  if (at < 0 && !otherwise.empty()) return otherwise[0];
  nb::object out = GetItem(self, key);
  DelItem(self, key);
  return out;
}

nb::dict Objects(const SpecMap& self) {
  nb::dict out;
  for (size_t i = 0; i < Size(self); ++i) {
    out[self.ops->key(MapOf(self), i).c_str()] = self.ops->get(MapOf(self), i, self.name);
  }
  return out;
}

using Entries = std::vector<std::pair<std::string, AnyBox>>;

Entries ToEntries(nb::handle value, const FieldPath& path, const MapOps& ops) {
  nb::object entries = nb::borrow(value);
  if (nb::hasattr(value, "items") && nb::hasattr(value, "keys")) entries = value.attr("items")();
  const std::string expected = fmt::format("a mapping of names to {}", ops.element);
  if (IsText(value) || entries.is(value)) ThrowType(path, expected, value);
  Entries out;
  for (const nb::object& entry : ToItems(entries, path, expected)) {
    if (IsText(entry) || !PySequence_Check(entry.ptr()) || nb::len(entry) != 2)
      ThrowType(path, expected, value);
    const std::string key = ToKey(entry[0], path);
    out.emplace_back(key, ops.box(entry[1], FieldPath(path, key)));
  }
  return out;
}

void Update(SpecMap& self, nb::handle other) {
  const FieldPath path(self.name);
  const Entries entries = ToEntries(other, path, *self.ops);
  for (const auto& [key, box] : entries) self.ops->set(MapOf(self), key, box);
}

void Clear(SpecMap& self) {
  while (Size(self) > 0) self.ops->erase(MapOf(self), Size(self) - 1);
}

bool Equal(const SpecMap& self, nb::handle other) {
  if (const SpecMap* map = nullptr; nb::try_cast(other, map) && map) {
    return self.ops == map->ops && self.ops->equal(MapOf(self), MapOf(*map));
  }
  return nb::isinstance<nb::dict>(other) && Objects(self).equal(other);
}

// --- Garbage collection --------------------------------------------------------------------------

template <class View>
int Traverse(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (!nb::inst_ready(self)) return 0;
  Py_VISIT(nb::inst_ptr<View>(self)->owner.ptr());
  return 0;
}

template <class View>
int Release(PyObject* self) {
  if (!nb::inst_ready(self)) return 0;
  View* view = nb::inst_ptr<View>(self);
  if constexpr (std::is_same_v<View, SpecList>) view->list = nullptr;
  if constexpr (std::is_same_v<View, SpecMap>) view->map = nullptr;
  view->owner.reset();
  return 0;
}

template <class View>
PyType_Slot kSlots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&Traverse<View>)},
                        {Py_tp_clear, reinterpret_cast<void*>(&Release<View>)},
                        {0, nullptr}};

// --- Classes -------------------------------------------------------------------------------------

constexpr const char* kListDoc =
    R"(The elements of a field such as SceneSpec.robots: a mutable sequence.

A live view: changes apply to the spec, and inserted elements keep their identity.
Elements may also be given as dictionaries of their fields.)";

constexpr const char* kMapDoc =
    R"(A field that maps names to values, such as RobotConfig.move_groups: a mutable mapping.

A live view: changes apply to the spec, and inserted specs keep their identity;
numbers come out as arrays that write through.)";

void BindList(nb::module_& m) {
  using List = SpecList;
  nb::class_<List> c(m, "SpecList", kListDoc,
                     nb::sig("class SpecList(collections.abc.MutableSequence[SpecT])"),
                     nb::type_slots(kSlots<List>));
  c.def("__len__", [](const List& self) { return Size(self); });
  c.def("__getitem__", nb::overload_cast<const List&, Py_ssize_t>(&GetItem),
        nb::sig("def __getitem__(self, index: int, /) -> SpecT"));
  c.def("__getitem__", &GetSlice, nb::sig("def __getitem__(self, index: slice, /) -> list[SpecT]"));
  c.def("__setitem__", nb::overload_cast<List&, Py_ssize_t, nb::handle>(&SetItem), nb::arg("index"),
        nb::arg("value").none(),
        nb::sig("def __setitem__(self, index: int, value: SpecT, /) -> None"));
  c.def("__setitem__", &SetSlice,
        nb::sig("def __setitem__(self, index: slice, value: collections.abc.Iterable[SpecT], /) -> "
                "None"));
  c.def("__delitem__", nb::overload_cast<List&, Py_ssize_t>(&DelItem),
        nb::sig("def __delitem__(self, index: int, /) -> None"));
  c.def("__delitem__", &DelSlice, nb::sig("def __delitem__(self, index: slice, /) -> None"));
  c.def(
      "__iter__", [](const List& self) { return nb::iter(Objects(self)); },
      nb::sig("def __iter__(self) -> collections.abc.Iterator[SpecT]"));
  c.def(
      "__contains__", [](const List& self, nb::handle value) { return Find(self, value) >= 0; },
      nb::arg("value").none(), nb::sig("def __contains__(self, value: object, /) -> bool"));
  c.def("__eq__", nb::overload_cast<const List&, nb::handle>(&Equal), nb::arg("other").none(),
        nb::sig("def __eq__(self, other: object, /) -> bool"));
  c.def("__repr__", [](const List& self) { return nb::repr(Objects(self)); });
  c.def("insert", &Insert, nb::arg("index"), nb::arg("value").none(),
        nb::sig("def insert(self, index: int, value: SpecT, /) -> None"),
        "Inserts before `index`.");
  c.def("append", &Append, nb::arg("value").none(),
        nb::sig("def append(self, value: SpecT, /) -> None"), "Appends an element.");
  c.def("extend", &Extend, nb::arg("values").none(),
        nb::sig("def extend(self, values: collections.abc.Iterable[SpecT], /) -> None"),
        "Appends all elements, or none if one is rejected.");
  c.def(
      "__iadd__",
      [](nb::handle_t<List> self, nb::handle values) {
        Extend(*nb::inst_ptr<List>(self), values);
        return nb::borrow(self);
      },
      nb::sig("def __iadd__(self, values: collections.abc.Iterable[SpecT], /) -> "
              "SpecList[SpecT]"));
  c.def("pop", nb::overload_cast<List&, Py_ssize_t>(&Pop), nb::arg("index") = -1,
        nb::sig("def pop(self, index: int = -1) -> SpecT"), "Removes and returns an element.");
  c.def(
      "remove",
      [](List& self, nb::handle value) {
        self.ops->splice(ListOf(self), FindOrThrow(self, value), 1, {});
      },
      nb::arg("value").none(), nb::sig("def remove(self, value: SpecT, /) -> None"),
      "Removes the first equal element.");
  c.def("index", nb::overload_cast<const List&, nb::handle>(&FindOrThrow), nb::arg("value").none(),
        nb::sig("def index(self, value: typing.Any, start: int = 0, stop: int = ...) -> int"),
        "Returns the index of the first equal element.");
  c.def(
      "count", [](const List& self, nb::handle v) { return Objects(self).attr("count")(v); },
      nb::arg("value").none(), nb::sig("def count(self, value: typing.Any, /) -> int"),
      "Returns the number of equal elements.");
  c.def(
      "clear", [](List& self) { self.ops->splice(ListOf(self), 0, Size(self), {}); },
      nb::sig("def clear(self) -> None"), "Removes all elements.");
  c.def(
      "reverse",
      [](List& self) { Rewrite(self, [](nb::object& objects) { objects.attr("reverse")(); }); },
      nb::sig("def reverse(self) -> None"), "Reverses the order.");
  c.attr("__hash__") = nb::none();
  nb::module_::import_("collections.abc").attr("MutableSequence").attr("register")(c);
}

void BindMap(nb::module_& m) {
  using Map = SpecMap;
  nb::class_<Map> c(m, "SpecMap", kMapDoc,
                    nb::sig("class SpecMap(collections.abc.MutableMapping[str, SpecT])"),
                    nb::type_slots(kSlots<Map>));
  c.def("__len__", [](const Map& self) { return Size(self); });
  c.def("__getitem__", nb::overload_cast<const Map&, nb::handle>(&GetItem),
        nb::sig("def __getitem__(self, key: str, /) -> SpecT"));
  c.def("__setitem__", nb::overload_cast<Map&, nb::handle, nb::handle>(&SetItem), nb::arg("key"),
        nb::arg("value").none(),
        nb::sig("def __setitem__(self, key: str, value: SpecT, /) -> None"));
  c.def("__delitem__", nb::overload_cast<Map&, nb::handle>(&DelItem),
        nb::sig("def __delitem__(self, key: str, /) -> None"));
  c.def(
      "__contains__", [](const Map& self, nb::handle key) { return Find(self, key) >= 0; },
      nb::arg("key").none(), nb::sig("def __contains__(self, key: object, /) -> bool"));
  c.def(
      "__iter__", [](const Map& self) { return nb::iter(Objects(self)); },
      nb::sig("def __iter__(self) -> collections.abc.Iterator[str]"));
  c.def("__eq__", nb::overload_cast<const Map&, nb::handle>(&Equal), nb::arg("other").none(),
        nb::sig("def __eq__(self, other: object, /) -> bool"));
  c.def("__repr__", [](const Map& self) {
    nb::dict out;
    for (const auto& [key, value] : Objects(self)) {
      out[key] = nb::hasattr(value, "tolist") ? value.attr("tolist")() : nb::borrow(value);
    }
    return nb::repr(out);
  });
  c.def(
      "keys", [](const Map& self) { return Objects(self).attr("keys")(); },
      nb::sig("def keys(self) -> collections.abc.KeysView[str]"), "Returns the names, in order.");
  c.def(
      "values", [](const Map& self) { return Objects(self).attr("values")(); },
      nb::sig("def values(self) -> collections.abc.ValuesView[SpecT]"),
      "Returns the values, in order.");
  c.def(
      "items", [](const Map& self) { return Objects(self).attr("items")(); },
      nb::sig("def items(self) -> collections.abc.ItemsView[str, SpecT]"),
      "Returns the names with their values, in order.");
  c.def(
      "get",
      [](const Map& self, nb::handle key, nb::handle otherwise) {
        return Find(self, key) < 0 ? nb::borrow(otherwise) : GetItem(self, key);
      },
      nb::arg("key"), nb::arg("default") = nb::none(),
      nb::sig("def get(self, key: str, default: typing.Any = None) -> typing.Any"),
      "Returns the value, or `default` for an unknown name.");
  c.def("pop", nb::overload_cast<Map&, nb::handle, nb::args>(&Pop),
        nb::sig("def pop(self, key: str, *default: typing.Any) -> typing.Any"),
        "Removes and returns a value.");
  c.def("update", &Update, nb::arg("other").none(),
        nb::sig("def update(self, other: collections.abc.Mapping[str, typing.Any], /) -> None"),
        "Sets all values of another mapping.");
  c.def("clear", &Clear, nb::sig("def clear(self) -> None"), "Removes all entries.");
  c.attr("__hash__") = nb::none();
  nb::module_::import_("collections.abc").attr("MutableMapping").attr("register")(c);
}

}  // namespace

void AssignList(void* list, const ListOps& ops, nb::handle value, const FieldPath& path) {
  const std::vector<AnyBox> boxes = ToBoxes(ops, value, path);
  ops.splice(list, 0, ops.size(list), boxes);
}

void AssignMap(void* map, const MapOps& ops, nb::handle value, const FieldPath& path) {
  const Entries entries = ToEntries(value, path, ops);
  while (ops.size(map) > 0) ops.erase(map, ops.size(map) - 1);
  for (const auto& [key, box] : entries) ops.set(map, key, box);
}

void BindSpecContainers(nb::module_& m) {
  m.attr("SpecT") = nb::type_var("SpecT");
  BindList(m);
  BindMap(m);
}

}  // namespace robocell::python
