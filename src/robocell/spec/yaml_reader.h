// Private to spec: the generic reader behind yaml.h, one overload of Read per kind of field. Only
// yaml*.cc and their tests include it (heavy header).
//
// The reader walks the declared fields, never the file's structure: the work for one value is
// bounded by the spec, and a limit on the number of values read keeps aliases from exploding.
//
// Templates know only the types of fields: the rest is compiled once, not for each of a hundred
// types.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "robocell/base/suggestions.h"
#include "robocell/spec/element_ref.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/task_spec.h"
#include "robocell/spec/validate.h"
#include "robocell/spec/yaml_hints.h"
#include "robocell/spec/yaml_stray.h"

namespace robocell::internal::yaml {

// Returns the tree of one document. Throws SpecError with source:line:column if the text is not
// YAML, is too large or too deep, or holds more than one document.
YAML::Node ParseText(std::string_view text, const std::string& source);

// A field given from outside the file; `path` as in messages: "cameras.streams[0].width".
struct Override {
  std::string path;
  std::string text;  // text as given: "task.lift_height=0.05"
  YAML::Node value;
  bool used = false;
};

// Throws ArgumentError unless it has the form path=value.
Override ParseOverride(const std::string& text);

class Reader {
 public:
  // `source` stands for the file in messages; relative paths inside start at `directory`.
  Reader(std::string source, std::string directory);
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  void AddOverride(Override value) { overrides_.push_back(std::move(value)); }

  // Reads a whole document and validates the result. problems() has all problems.
  template <HasFields T>
  void ReadDocument(const YAML::Node& root, T& out) {
    Mark(root);
    if (RefuseOtherKind<T>(root)) return;
    if (root.IsMap() || (root.IsNull() && !overrides_.empty())) {
      ReadFields(root, out);
      ReportUnusedOverrides();
      Problems found{Locations(sources_)};
      ValidateFields(out, found);
      AppendUnread(found);
    } else {
      FailNoFields(root, T::kTypeName, FieldNames<T>().front());
    }
  }

  const Problems& problems() const { return problems_; }

  // Gives the spec no locations, for text that is not a user's file.
  void ForgetLocations() { keep_locations_ = false; }

  void Read(const YAML::Node& node, bool& out);
  void Read(const YAML::Node& node, int& out);
  void Read(const YAML::Node& node, int64_t& out);
  void Read(const YAML::Node& node, double& out);
  void Read(const YAML::Node& node, std::string& out);
  void Read(const YAML::Node& node, NameList& out);
  void Read(const YAML::Node& node, IndexList& out);
  void Read(const YAML::Node& node, Pose& out);
  void Read(const YAML::Node& node, AttachTarget& out);
  void Read(const YAML::Node& node, RendererConfig& out);
  void Read(const YAML::Node& node, RenderQuality& out);
  void Read(const YAML::Node& node, ElementRef& out);
  void Read(const YAML::Node& node, RandomNumber& out);
  void Read(const YAML::Node& node, RandomProperty& out);
  void Read(const YAML::Node& node, RandomizedValue& out);
  void Read(const YAML::Node& node, RobotConfig& out);  // the fields, or the name of a robot file
  void Read(const YAML::Node& node, RobotSource& out);
  void Read(const YAML::Node& node, TaskSpec& out);
  void Read(const YAML::Node& node, SceneSourceSpec& out);

  template <class T>
  requires(IsOptional<T>::value) void Read(const YAML::Node& node, T& out) {
    if (node.IsNull()) return out.reset();
    Read(node, out.emplace());
  }

  template <HasEnumNames E>
  void Read(const YAML::Node& node, E& out) {
    if (const auto known = ReadOneOf(node, ValueNames<E>())) {
      out = EnumNames<E>::kNames[*known].first;
    }
  }

  template <class T, size_t N>
  void Read(const YAML::Node& node, std::array<T, N>& out) {
    if (!IsListOf(node, N, std::is_arithmetic_v<T> ? " numbers" : " names")) return;
    for (size_t i = 0; i < N; ++i) ReadItem(node[i], i, out[i]);
  }

  template <class T>
  void Read(const YAML::Node& node, std::vector<T>& out) {
    out.clear();
    if (IsSingle<T>(node)) return ReadItem(node, 0, out.emplace_back());
    if (!node.IsSequence()) return FailKind(node, "a list");
    for (size_t i = 0; i < node.size(); ++i) ReadItem(node[i], i, out.emplace_back());
  }

  template <class T>
  void Read(const YAML::Node& node, List<T>& out) {
    out.clear();
    if (!node.IsSequence()) return FailKind(node, "a list", DashHint(node));
    for (size_t i = 0; i < node.size(); ++i) ReadItem(node[i], i, out.push_back(T{}));
  }

  template <class T>
  static constexpr EntryForm FormOf() {
    if (IsVector<T>::value) return EntryForm::kList;
    return HasFields<T> || IsMap<T>::value || std::is_same_v<T, Pose> ? EntryForm::kOther
                                                                      : EntryForm::kScalar;
  }

  template <class T>
  void Read(const YAML::Node& node, Map<T>& out) {
    out.clear();
    if (!node.IsMap()) return FailKind(node, "names with values", NamesHint(node, FormOf<T>()));
    const auto read = [&](const YAML::Node&, const std::string& name, const YAML::Node& value) {
      T& item = *out.entries().emplace_back(name, std::make_shared<T>()).second;
      ReadAt(value, name, item);
    };
    ForEachKey(node, read, [](const std::string& name) {
      if constexpr (HasFields<T>) return IsOneOf(name, FieldNames<T>());
      return false;
    });
  }

  template <HasFields T>
  void Read(const YAML::Node& node, T& out) {
    if (!node.IsMap()) return FailNotFields(node, T::kTypeName, FieldHint<T>(node));
    ReadFields(node, out);
  }

  // A field beside those of a kind.
  struct NamedReader {
    std::string name = {};
    std::function<void(const YAML::Node& value)> read = {};
  };
  // Reads the kind that a map names (`implied` if it names none), and the fields of that kind.
  void ReadKind(const YAML::Node& node, KindSpec& out, const std::string& implied,
                const NamedReader& more);
  // Reads a value by its key; `doc` explains its problems.
  template <class T>
  void ReadExplainedValue(const YAML::Node& node, const std::string& name, const std::string& doc,
                          T& out) {
    ReadExplained(node, name, doc.c_str(), &ReadIntoA<T>, &out);
  }

 private:
  // Read() with the type hidden.
  using ReadInto = void (*)(Reader&, const YAML::Node&, void* out);
  template <class T>
  static void ReadIntoA(Reader& reader, const YAML::Node& node, void* out) {
    reader.Read(node, *static_cast<T*>(out));
  }

  // Reads values that are written without the names of fields.
  template <class T>
  static constexpr bool kPlain =
      std::is_arithmetic_v<T> || HasEnumNames<T> || std::is_same_v<T, std::string> ||
      std::is_same_v<T, NameList> || std::is_same_v<T, IndexList> || IsArray<T>::value;

  // Returns "; write {size: [0.2, 0.2, 0.3]}" if the node in place of T's fields fits as the value
  // of one of them; else the fields.
  template <HasFields T>
  std::string FieldHint(const YAML::Node& node) const {
    if (node.IsNull()) return "";
    const std::vector<std::string> names = FieldNames<T>();
    if (node.IsScalar()) {
      if (const std::string hint = NoBlankHint(node.Scalar(), names); !hint.empty()) {
        return "; " + hint;
      }
    }
    const char* fits = nullptr;
    T trial{};
    ForEachField(trial, [&](const char* name, auto& value, const char*, Bound) {
      if (fits == nullptr && FitsInto(node, value)) fits = name;
    });
    return FieldsHint(node, fits, names);
  }

  template <class T>
  bool FitsInto(const YAML::Node& node, T& out) const {
    if constexpr (IsOptional<T>::value) {
      return FitsInto(node, out.emplace());
    } else if constexpr (kPlain<T>) {
      return Fits(node, &ReadIntoA<T>, &out);
    }
    return false;
  }

  template <HasFields T>
  bool RefuseOtherKind(const YAML::Node& root) {
    if (!root.IsMap()) return false;
    root_fields_ = FieldNames<T>();
    const std::string other = OtherKindOfFile(root, T::kTypeName, root_fields_, source_);
    if (!other.empty()) Fail(root, other);
    return !other.empty();
  }

  // Returns true if reading it that way gives no problems.
  bool Fits(const YAML::Node& node, ReadInto read, void* out) const;
  // Returns the text of FieldHint for the field that fits, nullptr for none.
  static std::string FieldsHint(const YAML::Node& node, const char* fits,
                                const std::vector<std::string>& names);

  // Returns "file.yaml:3:7" of a node at the current path, or "--set ..." of the option that
  // replaced it.
  std::string At(const YAML::Node& node) const;
  void RememberEmpty(const YAML::Node& key, const YAML::Node& value);
  YAML::Mark MarkOf(const YAML::Node& node) const;
  // Stores the location of the current path for the checks that run after reading.
  void Mark(const YAML::Node& node);
  void Fail(const YAML::Node& node, const std::string& message);
  // Reports the expected form, the actual one, and the probable intention ("; write ...").
  void FailKind(const YAML::Node& node, const std::string& expected, const std::string& hint = "");
  void FailNoFields(const YAML::Node& root, const char* type, const std::string& example);
  void FailNotFields(const YAML::Node& node, const char* type, const std::string& hint);
  // Returns the value at the current path: the file's node, or the override's.
  YAML::Node Effective(const YAML::Node& node);
  // Returns the keys below the current path that overrides lead to.
  std::vector<std::string> OverriddenKeys() const;
  void ReportUnusedOverrides();
  // Adds the problems that validation found in values that could be read.
  void AppendUnread(const Problems& found);
  // Adds the field's documentation to the problems just found in its value as a whole.
  void ExplainField(std::string_view name, std::string_view doc, size_t first_problem);
  template <class Int>
  void ReadWhole(const YAML::Node& node, Int& out);
  bool ReadScalar(const YAML::Node& node, const std::string& expected, std::string& out);
  // Returns the index of the name; reports a problem if it is none of the names.
  std::optional<size_t> ReadOneOf(const YAML::Node& node, const std::vector<std::string>& names);
  // Returns true for a list of that length; otherwise reports a problem.
  bool IsListOf(const YAML::Node& node, size_t count, const char* items);
  void ReadRobotFile(const YAML::Node& node, RobotConfig& out);
  void ReadAttachWord(const YAML::Node& node, AttachTarget& out);

  // Replaces the problem of the last key's value by a report of the part that was probably cut off
  // from it.
  void ReportStray(const YAML::Node& key, const Stray& stray);

  static bool IsOneOf(const std::string& name, const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  }
  static Vec4 NormalizedFromWxyz(const Vec4& wxyz);

  // A single value stands for a list of one.
  template <class T>
  static bool IsSingle(const YAML::Node& node) {
    if constexpr (std::is_same_v<T, ElementRef>) return node.IsScalar() || node.IsMap();
    return (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>)&&node.IsScalar();
  }

  using OnKey =
      std::function<void(const YAML::Node& key, const std::string& name, const YAML::Node& value)>;
  using IsStrange = std::function<bool(const std::string& name)>;
  // Calls f(key node, key, value) once for each key, then for keys that only overrides have.
  // `strange(key)`: the map has no such key; instead of an entry it may be a field that lost its
  // indentation.
  void ForEachKey(const YAML::Node& node, const OnKey& f, const IsStrange& strange);

  template <class T>
  void ReadAt(const YAML::Node& node, std::string_view key, T& out) {
    ReadAt(node, key, &ReadIntoA<T>, &out);
  }
  void ReadAt(const YAML::Node& node, std::string_view key, ReadInto read, void* out);

  template <class T>
  void ReadItem(const YAML::Node& node, size_t i, T& out) {
    ReadItem(node, i, &ReadIntoA<T>, &out);
    problems_.NameEntry(i, LabelOf(out));
  }
  void ReadItem(const YAML::Node& node, size_t i, ReadInto read, void* out);
  void ReadHere(const YAML::Node& node, ReadInto read, void* out);

  template <HasFields T>
  void ReadFields(const YAML::Node& node, T& out) {
    bool quat = false, quat_wxyz = false;
    const auto read = [&](const YAML::Node& key, const std::string& name, const YAML::Node& value) {
      if (name == "quat") quat = true;
      if (ReadField(name, value, out)) return;
      if (ReadQuatWxyz(name, value, out)) return void(quat_wxyz = true);
      FailField(key, name, value, out);
      ReadAsMeant(node, name, value, out);
    };
    ForEachKey(node, read,
               [](const std::string& name) { return IsNoField(name, FieldNames<T>()); });
    if (quat && quat_wxyz) Fail(node, "both quat and quat_wxyz are given; keep one of them");
    if constexpr (requires { out.source_dir; }) out.source_dir = directory_;
    MarkMaps(out);
    if constexpr (requires { out.locations; }) {
      if (keep_locations_) out.locations = Locations(sources_, problems_.path());
    }
  }

  static bool IsNoField(const std::string& name, const std::vector<std::string>& fields);

  // The map fields of T, for locations.h.
  template <class T>
  void MarkMaps(T& out) {
    ForEachField(out, [&](const char* field, auto& value, const char*, Bound) {
      if constexpr (IsMap<std::remove_cvref_t<decltype(value)>>::value) MarkMap(field);
    });
  }

  void MarkMap(const char* field);

  template <class T>
  void FailField(const YAML::Node& key, const std::string& name, const YAML::Node& value,
                 const T& out) {
    std::vector<std::string> names = FieldNames<T>();
    if constexpr (requires { out.quat; }) names.push_back("quat_wxyz");
    const char* when_nested = nullptr;
    if constexpr (requires { T::kWhenNested; }) when_nested = T::kWhenNested;
    FailField(key, name, value, T::kTypeName, names, when_nested);
  }
  void FailField(const YAML::Node& key, const std::string& name, const YAML::Node& value,
                 const char* type, const std::vector<std::string>& names, const char* when_nested,
                 const std::string& more = "");
  // Returns where a field of the top level belongs that was given inside one of the file's values.
  std::string TopLevelHint(const std::string& name) const;

  // The value of a misspelt field counts as that of the field that was probably meant, so that the
  // field is not reported as missing too, nor any consequence of that.
  template <class T>
  void ReadAsMeant(const YAML::Node& node, const std::string& name, const YAML::Node& value,
                   T& out) {
    const std::string meant = MeantField(node, name, FieldNames<T>());
    if (meant.empty()) return;
    const size_t before = problems_.list().size();
    ReadField(meant, value, out);
    ForgetProblemsOf(meant, before);
  }
  // Returns "" if there is no such field, or if the file has it.
  static std::string MeantField(const YAML::Node& node, const std::string& name,
                                const std::vector<std::string>& fields);
  void ForgetProblemsOf(const std::string& field, size_t first_problem);

  template <class T>
  bool ReadField(const std::string& name, const YAML::Node& node, T& out) {
    bool found = false;
    ForEachField(out, [&](const char* field, auto& value, const char* doc, Bound) {
      if (found || name != field) return;
      found = true;
      ReadExplained(node, name, doc, &ReadIntoA<std::remove_cvref_t<decltype(value)>>, &value);
    });
    return found;
  }
  void ReadExplained(const YAML::Node& node, const std::string& name, const char* doc,
                     ReadInto read, void* out);

  // `quat_wxyz` is accepted wherever there is a `quat`: numbers copied from an MJCF file.
  template <class T>
  bool ReadQuatWxyz(const std::string& name, const YAML::Node& node, T& out) {
    if constexpr (requires { out.quat; }) {
      if (name != "quat_wxyz") return false;
      if (const auto quat = ReadWxyz(node, name)) out.quat = *quat;
      return true;
    }
    return false;
  }
  std::optional<Vec4> ReadWxyz(const YAML::Node& node, const std::string& name);

  std::string source_, directory_;
  std::vector<std::string> root_fields_;  // fields of the whole file's type
  std::shared_ptr<SourceMap> sources_ = std::make_shared<SourceMap>();
  Problems problems_{Locations(sources_)};
  std::vector<std::string> unread_;  // paths of misspelt fields that could not be read
  std::vector<Override> overrides_;
  bool keep_locations_ = true;
  // Missing values ("task:" with nothing), and the places of their names.
  std::vector<std::pair<YAML::Node, YAML::Mark>> empty_;
  size_t values_ = 0;
  size_t indices_ = 0;
};

// What FromYamlUnchecked returns.
template <class T>
T SpecOf(std::string_view text) {
  Reader reader("text", "");
  reader.ForgetLocations();
  T spec{};
  reader.Read(ParseText(text, "text"), spec);
  reader.problems().Throw("text");
  return spec;
}

}  // namespace robocell::internal::yaml
