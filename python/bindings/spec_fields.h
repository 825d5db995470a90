// A spec's fields in Python, made from its field declaration (robocell/spec/fields.h): reading,
// writing and annotation of each kind of field. Included by spec*.cc only.
//
// Reading gives a reference to everything that can be edited: nested specs, lists and mappings as
// live views, fixed arrays as NumPy views. Values cannot be changed (tuples, Pose, AttachTarget,
// ElementRef), so that no edit is ever lost silently.
#pragma once

#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "number_like.h"
#include "spec_containers.h"
#include "spec_enums.h"
#include "values.h"
#include "robocell/base/suggestions.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/task_spec.h"
#include "robocell/spec/validate.h"

namespace robocell::python {

// The operations on fields of one type, independent of their class.
struct FieldOps {
  std::string (*type)();  // annotations
  std::string (*set_type)();
  nb::object (*get)(void* value, const char* name, nb::handle self);
  void (*set)(void* value, nb::handle from, const FieldPath& path);
  bool (*equal)(const void* a, const void* b);
};

// A field of a spec class, with its type hidden.
struct Field {
  const char* name;
  const char* doc;
  std::string type, set_type;  // annotations
  size_t offset;               // offset in the spec
  const FieldOps* ops;

  nb::object get(void* spec, nb::handle self) const { return ops->get(In(spec), name, self); }
  void set(void* spec, nb::handle value, const FieldPath& path) const {
    ops->set(In(spec), value, path);
  }
  bool equal(const void* a, const void* b) const {
    return ops->equal(static_cast<const char*>(a) + offset, static_cast<const char*>(b) + offset);
  }

 private:
  void* In(void* spec) const { return static_cast<char*>(spec) + offset; }
};

void AddField(std::vector<Field>* fields, const char* name, const char* doc, const void* spec,
              const void* value, const FieldOps& ops);

// Sets fields from keyword arguments or a dictionary. Raises TypeError that names an unknown one
// with the nearest; `path` is the target, "" for a constructor.
void SetFields(const std::vector<Field>& fields, void* spec, const char* type, nb::handle values,
               const FieldPath* path);

template <HasFields T>
const std::vector<Field>& FieldsOf();

// Keeps texts to which nanobind has pointers.
const char* KeepText(std::string text);

// --- How each kind of field is converted ---------------------------------------------------------

// Get(value, name, owner): `owner` is the Python object that holds the value.
template <class T>
struct Convert;

AttachTarget ToAttachTarget(nb::handle value, const FieldPath& path);
ElementRef ToElementRef(nb::handle value, const FieldPath& path);

template <>
struct Convert<bool> {
  static std::string Type() { return "bool"; }
  static std::string SetType() { return Type(); }
  static nb::object Get(bool& value, const char*, nb::handle) { return nb::bool_(value); }
  static void Set(bool& out, nb::handle value, const FieldPath& path) { out = ToBool(value, path); }
};

template <std::integral T>
struct Convert<T> {
  static std::string Type() { return "int"; }
  static std::string SetType() { return Type(); }
  static nb::object Get(T& value, const char*, nb::handle) { return nb::int_(value); }
  static void Set(T& out, nb::handle value, const FieldPath& path) {
    using Limits = std::numeric_limits<T>;
    out = static_cast<T>(ToInt(value, path, Limits::min(), Limits::max()));
  }
};

template <>
struct Convert<double> {
  static std::string Type() { return "float"; }
  static std::string SetType() { return Type(); }
  static nb::object Get(double& value, const char*, nb::handle) { return nb::float_(value); }
  static void Set(double& out, nb::handle value, const FieldPath& path) {
    out = ToDouble(value, path);
  }
};

template <>
struct Convert<std::string> {
  static std::string Type() { return "str"; }
  static std::string SetType() { return "str | os.PathLike[str]"; }
  static nb::object Get(std::string& value, const char*, nb::handle) {
    return nb::str(value.c_str(), value.size());
  }
  static void Set(std::string& out, nb::handle value, const FieldPath& path) {
    out = ToText(value, path);
  }
};

// Accepts a value of the enum, or its name in YAML.
template <HasEnumNames E>
struct Convert<E> {
  static std::string Type() { return kEnumName<E>; }
  static std::string SetType() { return Type() + " | str"; }
  static nb::object Get(E& value, const char*, nb::handle) { return nb::cast(value); }
  static void Set(E& out, nb::handle value, const FieldPath& path) {
    if (nb::try_cast(value, out, /*convert=*/false)) return;
    if (!IsText(value)) {
      ThrowType(path, WithArticle(kEnumName<E>) + " or one of " + ListNames(ValueNames<E>()),
                value);
    }
    const std::string text = ToText(value, path);
    for (const auto& [known, name] : EnumNames<E>::kNames) {
      if (text == name) return void(out = known);
    }
    const std::vector<std::string> names = ValueNames<E>();
    ThrowValue(path, "must be one of " + ListNames(names) + ", got '" + text + "'." +
                         DidYouMean(text, names));
  }
};

template <class T>
requires(std::is_arithmetic_v<T>) inline constexpr const
    char* kArrayType = std::is_same_v<T, double> ? "numpy.typing.NDArray[numpy.float64]"
                                                 : "numpy.typing.NDArray[numpy.int32]";

// Fixed numbers: a view that writes through.
template <class T, size_t N>
requires(std::is_arithmetic_v<T>) struct Convert<std::array<T, N>> {
  static std::string Type() { return kArrayType<T>; }
  static std::string SetType() { return "numpy.typing.ArrayLike"; }
  static nb::object Get(std::array<T, N>& value, const char*, nb::handle owner) {
    return NumberView(value.data(), N, owner);
  }
  static void Set(std::array<T, N>& out, nb::handle value, const FieldPath& path) {
    if constexpr (std::is_same_v<T, double>) {
      const Numbers numbers(value, path, N);
      std::copy(numbers.span().begin(), numbers.span().end(), out.begin());
    } else {
      const std::vector<nb::object> items = ToItems(value, path, "whole numbers");
      if (items.size() != N) {
        ThrowValue(path, "must be " + std::to_string(N) + " whole numbers, got " +
                             std::to_string(items.size()));
      }
      std::array<T, N> numbers;
      for (size_t i = 0; i < N; ++i) {
        Convert<T>::Set(numbers[i], items[i], FieldPath(path, static_cast<Py_ssize_t>(i)));
      }
      out = numbers;
    }
  }
};

// Immutable sequences of small values: tuples.
template <class Sequence, class Item>
nb::object ToTuple(Sequence&& values, Item&& item) {
  nb::list out;
  for (auto& value : values) out.append(item(value));
  return nb::tuple(out);
}

inline nb::str Text(const std::string& text) { return nb::str(text.c_str(), text.size()); }

template <>
struct Convert<std::array<std::string, 2>> {
  static std::string Type() { return "tuple[str, str]"; }
  static std::string SetType() { return "collections.abc.Sequence[str]"; }
  static nb::object Get(std::array<std::string, 2>& value, const char*, nb::handle) {
    return nb::make_tuple(Text(value[0]), Text(value[1]));
  }
  static void Set(std::array<std::string, 2>& out, nb::handle value, const FieldPath& path) {
    if (IsText(value)) ThrowType(path, "a pair of names", value);
    const std::vector<std::string> names = ToTexts(value, path);
    if (names.size() != 2) {
      ThrowValue(path, "must be a pair of names, got " + std::to_string(names.size()));
    }
    out = {names[0], names[1]};
  }
};

template <>
struct Convert<AttachTarget> {
  static std::string Type() { return "AttachTarget"; }
  static std::string SetType() { return "AttachTarget | dict[str, str] | str"; }
  static nb::object Get(AttachTarget& value, const char*, nb::handle) { return nb::cast(value); }
  static void Set(AttachTarget& out, nb::handle value, const FieldPath& path) {
    out = ToAttachTarget(value, path);
  }
};

template <>
struct Convert<ElementRef> {
  static std::string Type() { return "ElementRef"; }
  static std::string SetType() { return "ElementRef | dict[str, typing.Any] | str"; }
  static nb::object Get(ElementRef& value, const char*, nb::handle) { return nb::cast(value); }
  static void Set(ElementRef& out, nb::handle value, const FieldPath& path) {
    out = ToElementRef(value, path);
  }
};

template <>
struct Convert<Pose> {
  static std::string Type() { return "Pose"; }
  static std::string SetType() { return Type(); }
  static nb::object Get(Pose& value, const char*, nb::handle) { return nb::cast(Pose(value)); }
  static void Set(Pose& out, nb::handle value, const FieldPath& path) {
    const Pose* pose = nullptr;
    if (!nb::try_cast(value, pose) || !pose) ThrowType(path, "a Pose", value);
    out = *pose;
  }
};

// A single item stands for a list of one if YAML allows that too.
template <class T>
requires(!std::is_arithmetic_v<T>) struct Convert<std::vector<T>> {
  static constexpr bool kSingle = !std::is_same_v<T, std::array<std::string, 2>>;
  static std::string Type() { return "tuple[" + Convert<T>::Type() + ", ...]"; }
  static std::string SetType() {
    const std::string item = Convert<T>::SetType();
    return "collections.abc.Iterable[" + item + "]" + (kSingle ? " | " + item : "");
  }
  static nb::object Get(std::vector<T>& value, const char* name, nb::handle owner) {
    return ToTuple(value, [&](T& item) { return Convert<T>::Get(item, name, owner); });
  }
  static void Set(std::vector<T>& out, nb::handle value, const FieldPath& path) {
    std::vector<T> values;
    if (kSingle && (IsText(value) || nb::isinstance<nb::dict>(value))) {
      Convert<T>::Set(values.emplace_back(), value, path);
    } else {
      for (const nb::object& item : ToItems(value, path, "a list")) {
        const FieldPath at(path, static_cast<Py_ssize_t>(values.size()));
        Convert<T>::Set(values.emplace_back(), item, at);
      }
    }
    out = std::move(values);
  }
};

// Numbers; a single one stands for a list of one.
template <>
struct Convert<std::vector<double>> {
  static std::string Type() { return "tuple[float, ...]"; }
  static std::string SetType() { return "collections.abc.Iterable[float] | float"; }
  static nb::object Get(std::vector<double>& value, const char*, nb::handle) {
    return ToTuple(value, [](double x) { return nb::float_(x); });
  }
  static void Set(std::vector<double>& out, nb::handle value, const FieldPath& path) {
    if (IsNumber(value)) {
      out = {ToDouble(value, path)};
    } else {
      const Numbers numbers(value, path, "a number or a list of numbers");
      out.assign(numbers.span().begin(), numbers.span().end());
    }
  }
};

template <>
struct Convert<NameList> {
  static std::string Type() { return "tuple[str, ...]"; }
  static std::string SetType() { return "collections.abc.Iterable[str] | str"; }
  static nb::object Get(NameList& value, const char*, nb::handle) {
    return ToTuple(value.names, Text);
  }
  static void Set(NameList& out, nb::handle value, const FieldPath& path) {
    out = IsText(value) ? NameList::Expand(ToText(value, path)) : NameList(ToTexts(value, path));
  }
};

template <>
struct Convert<IndexList> {
  static std::string Type() { return "tuple[int, ...]"; }
  static std::string SetType() { return "collections.abc.Iterable[int]"; }
  static nb::object Get(IndexList& value, const char*, nb::handle) {
    return ToTuple(value.values, [](int i) { return nb::int_(i); });
  }
  static void Set(IndexList& out, nb::handle value, const FieldPath& path) {
    IndexList list;
    for (const nb::object& item : ToItems(value, path, "whole numbers")) {
      const FieldPath at(path, static_cast<Py_ssize_t>(list.size()));
      Convert<int>::Set(list.values.emplace_back(), item, at);
    }
    out = std::move(list);
  }
};

// --- Specs inside specs --------------------------------------------------------------------------

// Specs whose first two fields can be given as a pair.
template <class S>
concept IsPair = requires {
  S::kWrittenAsPair;
};

template <class S>
Box<S> PairToSpecBox(nb::handle pair, const FieldPath& path) {
  auto box = std::make_shared<S>();
  for (int i = 0; i < 2; ++i) {
    const Field& field = FieldsOf<S>()[i];
    field.set(box.get(), pair[i], FieldPath(path, field.name));
  }
  return box;
}

// Returns true if a dictionary has keys other than fields, in the form of whole specs.
bool HoldsOthers(const std::vector<Field>& fields, nb::handle dict);

// Specs that a plain number can stand for.
template <class S>
inline constexpr bool kIsNumber =
    std::is_same_v<S, RandomNumber> || std::is_same_v<S, RandomProperty>;

inline bool IsPath(nb::handle value) { return IsText(value) || nb::hasattr(value, "__fspath__"); }

// Accepts an object of class S, a dictionary of its fields, or another form in which it can be
// written.
template <HasFields S>
Box<S> ToSpecBox(nb::handle value, const FieldPath& path) {
  if constexpr (IsPair<S>) {
    if (nb::isinstance<nb::tuple>(value) && nb::len(value) == 2)
      return PairToSpecBox<S>(value, path);
  }
  if constexpr (std::is_same_v<S, RobotConfig>) {
    if (IsPath(value)) return std::make_shared<S>(RobotConfig::Load(ToText(value, path)));
  }
  if constexpr (kIsNumber<S>) {
    if (IsNumber(value)) {
      auto number = std::make_shared<S>();
      number->value = ToDouble(value, path);
      return number;
    }
  }
  if constexpr (std::is_same_v<S, RandomizedValue>) {
    if (!nb::isinstance<nb::dict>(value) && !nb::isinstance<S>(value)) {
      auto values = std::make_shared<S>();
      if (IsText(value))
        values->word = ToText(value, path);
      else
        Convert<std::vector<double>>::Set(values->numbers, value, path);
      return values;
    }
  }
  Box<S> box;
  if (nb::isinstance<nb::dict>(value)) {
    if constexpr (requires { S::kWhenNested; }) {
      if (HoldsOthers(FieldsOf<S>(), value))
        ThrowValue(path, std::string("is wrong: ") + S::kWhenNested);
    }
    box = std::make_shared<S>();
    SetFields(FieldsOf<S>(), box.get(), S::kTypeName, value, &path);
  } else if (value.is_none() || !nb::try_cast(value, box, /*convert=*/false) || !box) {
    ThrowType(path, WithArticle(S::kTypeName), value);
  }
  return box;
}

template <HasFields S>
struct Convert<S> {
  static std::string Type() { return S::kTypeName; }
  static std::string SetType() {
    std::string type = Type() + " | dict[str, typing.Any]";
    if constexpr (IsPair<S>) {
      type += fmt::format(" | tuple[{}, {}]", FieldsOf<S>()[0].set_type, FieldsOf<S>()[1].set_type);
    }
    if constexpr (std::is_same_v<S, RobotConfig>) type += " | str | os.PathLike[str]";
    if constexpr (kIsNumber<S>) type += " | float";
    if constexpr (std::is_same_v<S, RandomizedValue>)
      type += " | float | str | collections.abc.Iterable[float]";
    return type;
  }
  static nb::object Get(S& value, const char*, nb::handle owner) {
    return nb::cast(&value, nb::rv_policy::reference_internal, owner);
  }
  static void Set(S& out, nb::handle value, const FieldPath& path) {
    const S copy = *ToSpecBox<S>(value, path);
    out = copy;
  }
};

template <class T>
struct Convert<std::optional<T>> {
  static std::string Type() { return Convert<T>::Type() + " | None"; }
  static std::string SetType() { return Convert<T>::SetType() + " | None"; }
  static nb::object Get(std::optional<T>& value, const char* name, nb::handle owner) {
    return value ? Convert<T>::Get(*value, name, owner) : nb::object(nb::none());
  }
  static void Set(std::optional<T>& out, nb::handle value, const FieldPath& path) {
    if (value.is_none()) return out.reset();
    T item = out.value_or(T{});
    Convert<T>::Set(item, value, path);
    out = std::move(item);
  }
};

template <class S>
struct Convert<Maybe<S>> {
  static std::string Type() { return std::string(S::kTypeName) + " | None"; }
  static std::string SetType() { return Convert<S>::SetType() + " | None"; }
  static nb::object Get(Maybe<S>& value, const char*, nb::handle) {
    return value ? nb::cast(value.box()) : nb::object(nb::none());
  }
  static void Set(Maybe<S>& out, nb::handle value, const FieldPath& path) {
    Box<S> box = value.is_none() ? nullptr : ToSpecBox<S>(value, path);
    std::swap(out.box(), box);
  }
};

template <class S>
const ListOps* ListOpsOf() {
  using Boxes = std::vector<Box<S>>;
  static const ListOps kOps = {
      S::kTypeName,
      [](const void* list) { return static_cast<const List<S>*>(list)->size(); },
      [](void* list, size_t i) { return nb::cast(static_cast<List<S>*>(list)->boxes()[i]); },
      [](nb::handle value, const FieldPath& path) -> AnyBox { return ToSpecBox<S>(value, path); },
      [](void* list, size_t at, size_t count, const std::vector<AnyBox>& boxes) {
        // Builds the list aside and swaps it: destroying the old elements may run Python code,
        // which must see a complete list.
        const Boxes& old = static_cast<List<S>*>(list)->boxes();
        Boxes result(old.begin(), old.begin() + at);
        for (const AnyBox& box : boxes) result.push_back(std::static_pointer_cast<S>(box));
        result.insert(result.end(), old.begin() + at + count, old.end());
        std::swap(static_cast<List<S>*>(list)->boxes(), result);
      },
      [](const void* a, const void* b) {
        return *static_cast<const List<S>*>(a) == *static_cast<const List<S>*>(b);
      }};
  return &kOps;
}

template <class S>
struct Convert<List<S>> {
  static std::string Type() { return std::string("SpecList[") + S::kTypeName + "]"; }
  static std::string SetType() { return "collections.abc.Iterable[" + Convert<S>::SetType() + "]"; }
  static nb::object Get(List<S>& value, const char* name, nb::handle owner) {
    return nb::cast(SpecList{nb::borrow(owner), name, &value, ListOpsOf<S>()});
  }
  static void Set(List<S>& out, nb::handle value, const FieldPath& path) {
    AssignList(&out, *ListOpsOf<S>(), value, path);
  }
};

template <class T>
const MapOps* MapOpsOf();

// The values of a mapping: specs, enums, poses, lists of numbers, or mappings of these. Element()
// is their name in messages.
template <class T>
struct MapValue {
  static std::string Type() { return Convert<T>::Type(); }
  static std::string SetType() { return Convert<T>::SetType(); }
  static std::string Element() { return Type(); }
  static nb::object Get(Box<T>& box, const FieldPath&) {
    return Convert<T>::Get(*box, "", nb::handle());
  }
  static Box<T> ToBox(nb::handle value, const FieldPath& path) {
    auto box = std::make_shared<T>();
    Convert<T>::Set(*box, value, path);
    return box;
  }
};

template <HasFields S>
struct MapValue<S> {
  static std::string Type() { return S::kTypeName; }
  static std::string SetType() { return Convert<S>::SetType(); }
  static std::string Element() { return Type(); }
  static nb::object Get(Box<S>& box, const FieldPath&) { return nb::cast(box); }
  static Box<S> ToBox(nb::handle value, const FieldPath& path) { return ToSpecBox<S>(value, path); }
};

template <>
struct MapValue<std::vector<double>> {
  static std::string Type() { return kArrayType<double>; }
  static std::string SetType() { return "numpy.typing.ArrayLike"; }
  static std::string Element() { return "numbers"; }
  static nb::object Get(Box<std::vector<double>>& box, const FieldPath&) {
    return NumberView(box->data(), box->size(), Keeper(box));
  }
  static Box<std::vector<double>> ToBox(nb::handle value, const FieldPath& path) {
    const Numbers numbers(value, path);
    return std::make_shared<std::vector<double>>(numbers.span().begin(), numbers.span().end());
  }
};

// A mapping of names to mappings.
template <class S>
struct MapValue<Map<S>> {
  static std::string Type() { return "SpecMap[" + MapValue<S>::Type() + "]"; }
  static std::string SetType() {
    return "collections.abc.Mapping[str, " + MapValue<S>::SetType() + "]";
  }
  static std::string Element() { return "mappings of names to " + MapValue<S>::Element(); }
  static nb::object Get(Box<Map<S>>& box, const FieldPath& path) {
    return nb::cast(SpecMap{Keeper(box), path.text(), box.get(), MapOpsOf<S>()});
  }
  static Box<Map<S>> ToBox(nb::handle value, const FieldPath& path) {
    auto box = std::make_shared<Map<S>>();
    AssignMap(box.get(), *MapOpsOf<S>(), value, path);
    return box;
  }
};

template <class T>
const MapOps* MapOpsOf() {
  static const std::string kElement = MapValue<T>::Element();
  static const MapOps kOps = {
      kElement.c_str(),
      [](const void* map) { return static_cast<const Map<T>*>(map)->size(); },
      [](const void* map, size_t i) { return static_cast<const Map<T>*>(map)->entries()[i].first; },
      [](void* map, size_t i, const std::string& name) {
        auto& [key, box] = static_cast<Map<T>*>(map)->entries()[i];
        const FieldPath path(name);
        return MapValue<T>::Get(box, FieldPath(path, key));
      },
      [](nb::handle value, const FieldPath& path) -> AnyBox {
        return MapValue<T>::ToBox(value, path);
      },
      [](void* map, const std::string& key, const AnyBox& box) {
        Box<T> item = std::static_pointer_cast<T>(box);
        auto& entries = static_cast<Map<T>*>(map)->entries();
        for (auto& entry : entries) {
          if (entry.first == key) return std::swap(entry.second, item);
        }
        entries.emplace_back(key, std::move(item));
      },
      [](void* map, size_t i) {
        auto& entries = static_cast<Map<T>*>(map)->entries();
        const auto dropped = std::move(entries[i]);
        entries.erase(entries.begin() + i);
      },
      [](const void* a, const void* b) {
        return *static_cast<const Map<T>*>(a) == *static_cast<const Map<T>*>(b);
      }};
  return &kOps;
}

template <class T>
struct Convert<Map<T>> {
  static std::string Type() { return "SpecMap[" + MapValue<T>::Type() + "]"; }
  static std::string SetType() {
    return "collections.abc.Mapping[str, " + MapValue<T>::SetType() + "]";
  }
  static nb::object Get(Map<T>& value, const char* name, nb::handle owner) {
    return nb::cast(SpecMap{nb::borrow(owner), name, &value, MapOpsOf<T>()});
  }
  static void Set(Map<T>& out, nb::handle value, const FieldPath& path) {
    AssignMap(&out, *MapOpsOf<T>(), value, path);
  }
};

// The robot of a run: its configuration by reference; set from a RobotConfig or a file's name.
template <>
struct Convert<RobotSource> {
  static std::string Type() { return "RobotConfig"; }
  static std::string SetType() { return Convert<RobotConfig>::SetType(); }
  static nb::object Get(RobotSource& value, const char* name, nb::handle owner) {
    return Convert<RobotConfig>::Get(value.config, name, owner);
  }
  static void Set(RobotSource& out, nb::handle value, const FieldPath& path) {
    Convert<RobotConfig>::Set(out.config, value, path);
    out.file = IsPath(value) ? ToText(value, path) : "";
  }
};

// The scenes of a run: the fields of their source's kind by reference (spec_scenes.cc).
SceneSourceSpec ScenesFromPython(nb::handle value, const FieldPath& path);

template <>
struct Convert<SceneSourceSpec> {
  static std::string Type() { return "SceneSourceSpec"; }
  static std::string SetType() { return "SceneSourceSpec | dict[str, typing.Any]"; }
  static nb::object Get(SceneSourceSpec& value, const char*, nb::handle owner) {
    return nb::cast(&value, nb::rv_policy::reference_internal, owner);
  }
  static void Set(SceneSourceSpec& out, nb::handle value, const FieldPath& path) {
    out = ScenesFromPython(value, path);
  }
};

// The task of a run or environment: its fields, as an object of their kind's class (spec_task.cc).
nb::object TaskSpecToPython(TaskSpec& value);
TaskSpec TaskSpecFromPython(nb::handle value, const FieldPath& path);
// The annotation of what TaskSpecFromPython takes.
std::string TaskTypes();

template <>
struct Convert<TaskSpec> {
  // The class depends on the kind, which an annotation cannot express.
  static std::string Type() { return "typing.Any"; }
  static std::string SetType() { return TaskTypes(); }
  static nb::object Get(TaskSpec& value, const char*, nb::handle) {
    return TaskSpecToPython(value);
  }
  static void Set(TaskSpec& out, nb::handle value, const FieldPath& path) {
    out = TaskSpecFromPython(value, path);
  }
};

// --- All fields of a class -----------------------------------------------------------------------

template <class Value>
inline constexpr FieldOps kFieldOps = {
    &Convert<Value>::Type, &Convert<Value>::SetType,
    [](void* value, const char* name, nb::handle self) -> nb::object {
      return Convert<Value>::Get(*static_cast<Value*>(value), name, self);
    },
    [](void* value, nb::handle from, const FieldPath& path) {
      Convert<Value>::Set(*static_cast<Value*>(value), from, path);
    },
    [](const void* a, const void* b) {
      return *static_cast<const Value*>(a) == *static_cast<const Value*>(b);
    }};

// Returns " Shape (3,)." for a field of three numbers, "" for a field of another kind.
template <class T>
std::string ShapeNote() {
  if constexpr (IsOptional<T>::value) {
    return ShapeNote<std::remove_cvref_t<decltype(*std::declval<T&>())>>();
  } else if constexpr (requires { std::tuple_size<T>::value; }) {
    if constexpr (std::is_arithmetic_v<typename T::value_type>) {
      return " Shape (" + std::to_string(std::tuple_size<T>::value) + ",).";
    }
  }
  return "";
}

template <HasFields T>
const std::vector<Field>& FieldsOf() {
  static const std::vector<Field> kFields = [] {
    std::vector<Field> fields;
    const T plain{};
    ForEachField(plain, [&](const char* name, const auto& value, const char* doc, Bound) {
      using Value = std::remove_cvref_t<decltype(value)>;
      const std::string note = ShapeNote<Value>();
      const char* shown = note.empty() ? doc : KeepText(doc + note);
      AddField(&fields, name, shown, &plain, &value, kFieldOps<Value>);
    });
    return fields;
  }();
  return kFields;
}

}  // namespace robocell::python
