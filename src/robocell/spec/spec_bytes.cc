// One overload of Write per kind of field. A length precedes each value of variable length, so that
// different specs never give the same bytes.
#include "robocell/spec/spec_bytes.h"

#include <array>
#include <type_traits>
#include <utility>
#include <vector>

#include "robocell/spec/scene_spec.h"
#include "robocell/spec/validate.h"

namespace robocell::internal {
namespace {

class ByteWriter {
 public:
  std::string Take() { return std::move(bytes_); }

  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void Write(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void Write(double value) {
    value += 0.0;  // -0 equals 0
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void Write(const std::string& value) {
    Write(value.size());
    bytes_ += value;
  }
  void Write(const NameList& value) { Write(value.names); }
  void Write(const Pose& value) {
    for (const double x : value.translation()) Write(x);
    for (const double x : value.quaternion()) Write(x);
  }
  void Write(const AttachTarget& value) {
    Write(value.kind);
    Write(value.name);
  }
  void Write(const ElementRef& value) {
    Write(value.kind);
    Write(value.name);
    Write(value.body);
    Write(value.index);
  }
  template <class T>
  requires(IsOptional<T>::value) void Write(const T& value) {
    Write(value.has_value());
    if (value) Write(*value);
  }
  template <class T, size_t N>
  void Write(const std::array<T, N>& value) {
    for (const T& element : value) Write(element);
  }
  template <class T>
  void Write(const std::vector<T>& value) {
    WriteSequence(value);
  }
  template <class T>
  void Write(const List<T>& value) {
    WriteSequence(value);
  }
  template <class T>
  void Write(const Map<T>& value) {
    Write(value.size());
    for (const auto& [key, box] : value.entries()) {
      Write(key);
      Write(*box);
    }
  }
  template <HasFields T>
  void Write(const T& value) {
    T::Fields(
        [&](const char*, auto member, const char*, Bound = Bound::kNone) { Write(value.*member); });
  }

 private:
  template <class T>
  void WriteSequence(const T& values) {
    Write(values.size());
    for (const auto& value : values) Write(value);
  }

  std::string bytes_;
};

}  // namespace

std::string SpecBytes(const SceneSpec& spec) {
  ByteWriter writer;
  writer.Write(spec);
  return writer.Take();
}

}  // namespace robocell::internal
