// Private to spec: the generic writer behind ToYaml, one overload of Write per kind of field. Only
// yaml*.cc and their tests include it.
//
// Unset optionals and empty containers are left out; numbers have enough digits to be read back to
// the bit.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/task_spec.h"
#include "robocell/spec/validate.h"

namespace robocell::internal::yaml {

class Writer {
 public:
  Writer();
  ~Writer();
  std::string text() const { return out_.c_str(); }

  void Write(bool value) { out_ << value; }
  void Write(int value) { out_ << value; }
  void Write(int64_t value) { out_ << value; }
  void Write(double value);
  void Write(const std::string& value);
  void Write(const NameList& value);
  void Write(const IndexList& value);
  void Write(const Pose& value);
  void Write(const AttachTarget& value);
  void Write(const ElementRef& value);
  void Write(const RandomNumber& value);
  void Write(const RandomizedValue& value);
  void Write(const RobotSource& value) { Write(value.config); }
  void Write(const TaskSpec& value) {
    BeginMap();
    WriteKind(value);
    EndMap();
  }
  void Write(const SceneSourceSpec& value) {
    BeginMap();
    WriteKind(value);
    if (!value.houses.empty()) WriteField("houses", value.houses);
    EndMap();
  }
  template <HasEnumNames E>
  void Write(E value) {
    WriteWord(ToString(value));
  }
  template <class T>
  requires(IsOptional<T>::value) void Write(const T& value) {
    if (!value) return WriteNull();
    Write(*value);
  }
  template <class T, size_t N>
  void Write(const std::array<T, N>& value) {
    WriteSequence(value, true);
  }
  template <class T>
  void Write(const std::vector<T>& value) {
    WriteSequence(value, true);
  }
  template <class T>
  void Write(const List<T>& value) {
    WriteSequence(value, false);
  }
  template <class T>
  void Write(const Map<T>& value) {
    BeginMap();
    for (const auto& [key, box] : value.entries()) {
      WriteKey(key);
      Write(*box);
    }
    EndMap();
  }
  template <HasFields T>
  void Write(const T& value) {
    WriteFields(value);
  }
  template <class T>
  void WriteField(const std::string& name, const T& value) {
    WriteKey(name);
    Write(value);
  }

 private:
  template <HasFields T>
  void WriteFields(const T& value) {
    BeginMap();
    [[maybe_unused]] static const T kDefault{};
    T::Fields([&](const char* name, auto member, const char*, Bound = Bound::kNone) {
      const auto& field = value.*member;
      // Empty values are left out, unless that would restore a default that is not empty.
      if (IsAbsent(field) && IsAbsent(kDefault.*member)) return;
      WriteKey(name);
      Write(field);
    });
    EndMap();
  }
  template <class T>
  static bool IsAbsent(const T& value) {
    if constexpr (requires { value.has_value(); }) return !value.has_value();
    if constexpr (requires { value.empty(); }) return value.empty();
    return false;
  }
  template <class T>
  void WriteSequence(const T& values, bool flow) {
    BeginSequence(flow);
    for (const auto& value : values) Write(value);
    EndSequence();
  }
  // Writes the kind and its fields within a map.
  void WriteKind(const KindSpec& value);
  // Code that does not depend on a type is compiled once.
  void BeginMap();
  void WriteKey(const char* key);
  void WriteKey(const std::string& key);
  void EndMap();
  void BeginSequence(bool flow);
  void EndSequence();
  void WriteNull();
  void WriteWord(const char* word);

  YAML::Emitter out_;
};

// What ToYaml returns.
template <class T>
std::string TextOf(const T& spec) {
  Writer writer;
  writer.Write(spec);
  return writer.text() + "\n";
}

}  // namespace robocell::internal::yaml
