// For tests only: fills any spec with random values through its field declarations. The result
// obeys the types, but not the rules between fields (Validate may reject it).
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/math/rotation.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/validate.h"

namespace robocell::testing {

class RandomSpec {
 public:
  explicit RandomSpec(uint64_t seed) : rng_(Rng::Stream(seed, "random spec")) {}

  template <class T>
  T Make() {
    T value{};
    Fill(value);
    return value;
  }

  // Fills every field of `spec`, including nested ones.
  template <class T>
  void Fill(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      value = rng_.UniformInt(2) == 1;
    } else if constexpr (std::is_integral_v<T>) {
      value = static_cast<T>(rng_.NextBits() >> rng_.UniformInt(64));
    } else if constexpr (std::is_floating_point_v<T>) {
      value = Number();
    } else if constexpr (HasEnumNames<T>) {
      value = EnumNames<T>::kNames[rng_.UniformInt(EnumNames<T>::kNames.size())].first;
    } else if constexpr (IsOptional<T>::value) {
      value.reset();
      if (rng_.UniformInt(4) > 0) Fill(value.emplace());
    } else if constexpr (IsArray<T>::value) {
      for (auto& item : value) Fill(item);
    } else if constexpr (IsVector<T>::value) {
      value.resize(rng_.UniformInt(4));
      for (auto& item : value) Fill(item);
    } else if constexpr (IsList<T>::value) {
      value.clear();
      for (uint64_t n = rng_.UniformInt(3); n > 0; --n) Fill(value.push_back({}));
    } else if constexpr (IsMap<T>::value) {
      value.clear();
      for (uint64_t n = rng_.UniformInt(3); n > 0; --n) Fill(value[Text()]);
    } else if constexpr (HasFields<T>) {
      ForEachField(value, [&](const char*, auto& field, const char*, Bound) { Fill(field); });
    } else {
      FillOther(value);
    }
  }

 private:
  void FillOther(std::string& value) { value = Text(); }
  void FillOther(NameList& value) { Fill(value.names); }
  void FillOther(IndexList& value) {
    value.values.clear();
    const int first = static_cast<int>(rng_.UniformInt(100));
    const int step = static_cast<int>(rng_.UniformInt(2)) + 1;
    for (int i = 0; i < static_cast<int>(rng_.UniformInt(6)); ++i) {
      value.values.push_back(first + step * i);
    }
  }
  void FillOther(Pose& value) {
    value = Pose(Eigen::Vector3d(Number(), Number(), Number()), RandomQuaternion(rng_));
  }
  void FillOther(AttachTarget& value) {
    Fill(value.kind);
    const bool frame = value.kind == AttachKind::kWorld || value.kind == AttachKind::kRoot ||
                       value.kind == AttachKind::kSharedBase;
    value.name = frame ? "" : Text();
  }
  void FillOther(ElementRef& value) {
    value = {};
    if (rng_.UniformInt(2)) Fill(value.kind.emplace());
    if (rng_.UniformInt(2)) return void(value.name = Text());
    value.body = Text();
    value.index = static_cast<int>(rng_.UniformInt(9));
  }
  void FillOther(RobotSource& value) { Fill(value.config); }
  void FillOther(SceneSourceSpec& value) {
    value = SceneSourceSpec();
    if (rng_.UniformInt(2)) {
      value = FilesScenes();
      Fill(value.As<FilesScenes>());
    }
    FillOther(value.houses);
  }
  // Returns a spec of any registered kind.
  void FillOther(TaskSpec& value) {
    const std::vector<std::string> kinds = TaskKinds();
    value = TaskSpec(kinds[rng_.UniformInt(kinds.size())]);
    for (const KindFieldRef& field : value.fields().refs())
      std::visit([&](auto* member) { Fill(*member); }, field.value);
  }

  // Returns numbers of any size, short and long ones, whole ones.
  double Number() {
    switch (rng_.UniformInt(4)) {
      case 0:
        return static_cast<double>(rng_.UniformInt(9)) - 4;
      case 1:
        return rng_.Uniform(-1, 1);
      case 2:
        return std::ldexp(rng_.Uniform(-1, 1), static_cast<int>(rng_.UniformInt(2000)) - 1000);
      default:
        return std::round(rng_.Uniform(-1000, 1000)) / 1000;
    }
  }

  // Returns plain names and texts with special meanings in YAML; never the same one twice.
  std::string Text() {
    static const std::vector<std::string> kTexts = {
        "arm",     "joint", "true", "null",  "~",        "3",      "1e5",    "0x1F", "a b",
        " a ",     "- a",   "# no", "a: b",  "{a",       "[b",     "\"q\"",  "it's", "&a",
        "*a",      "!t",    "%p",   "@h",    "a\nb",     "tab\tc", "é ü 手", "<<",   "yes",
        "a\\b",    "|",     ">",    "? k",   ".nan",     "a#b",    ",",      "a,b",  "---",
        "a/b.xml", "a: ",   "=",    "`cmd`", "\x01\x7f", "😀",      "a\r\n",  "\n",   "..."};
    return kTexts[rng_.UniformInt(kTexts.size())] + (rng_.UniformInt(2) ? "" : " ") +
           std::to_string(++count_) + (rng_.UniformInt(2) ? "" : ":");
  }

  Rng rng_;
  int count_ = 0;
};

}  // namespace robocell::testing
