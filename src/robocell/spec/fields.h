// A spec struct declares its fields once. YAML, equality, validation, Python and the reference docs
// all use this declaration:
//
//   struct CameraMount {
//     std::string name;
//     double fovy = 45;
//     static constexpr const char* kTypeName = "CameraMount";
//     template <class V> static void Fields(V&& v) {
//       v("name", &CameraMount::name, "Name of the camera in the scene.");
//       v("fovy", &CameraMount::fovy, "Vertical field of view, degrees.", Bound::kPositive);
//     }
//   };
//
// A visitor is called with (name, pointer to member, doc[, Bound]). Field types: bool, int, int64,
// double, std::string, enums with EnumNames, std::optional, std::array<double, N>, std::vector of
// those, NameList, Pose, nested structs, List<T>, Map<T>, Maybe<T>.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace robocell {

// Ranges that numbers may be restricted to. All numbers must be finite in any case.
enum class Bound { kNone, kPositive, kNonNegative, kFraction };

namespace detail {
struct AnyVisitor {
  template <class M, class C>
  void operator()(const char*, M C::*, const char*, Bound = Bound::kNone) {}
};
}  // namespace detail

template <class T>
concept HasFields = requires {
  T::Fields(detail::AnyVisitor{});
};

// Calls f(const char* name, M& value, const char* doc, Bound) for every field of `object`.
template <HasFields T, class F>
void ForEachField(T& object, F&& f) {
  std::remove_const_t<T>::Fields(
      [&](const char* name, auto member, const char* doc, Bound bound = Bound::kNone) {
        f(name, object.*member, doc, bound);
      });
}

// Returns the names of T's fields in order of declaration.
template <HasFields T>
std::vector<std::string> FieldNames() {
  std::vector<std::string> names;
  T::Fields(
      [&](const char* name, auto, const char*, Bound = Bound::kNone) { names.emplace_back(name); });
  return names;
}

// Specs are equal when all their fields are.
template <HasFields T>
bool operator==(const T& a, const T& b) {
  bool equal = true;
  T::Fields([&](const char*, auto member, const char*, Bound = Bound::kNone) {
    if (equal) equal = a.*member == b.*member;
  });
  return equal;
}

// Text names of an enum's values: specialise with `static constexpr std::array kNames =
// {std::pair{E::kA, "a"}, ...};`.
template <class E>
struct EnumNames;

template <class E>
concept HasEnumNames = requires {
  EnumNames<E>::kNames.size();
};

// Returns false for a number that is not a value of the enum; only a cast makes one.
template <HasEnumNames E>
bool IsNamed(E value) {
  for (const auto& [v, name] : EnumNames<E>::kNames) {
    if (v == value) return true;
  }
  return false;
}

template <HasEnumNames E>
const char* ToString(E value) {
  for (const auto& [v, name] : EnumNames<E>::kNames) {
    if (v == value) return name;
  }
  return "?";
}

template <HasEnumNames E>
std::vector<std::string> ValueNames() {
  std::vector<std::string> names;
  for (const auto& [v, name] : EnumNames<E>::kNames) names.emplace_back(name);
  return names;
}

}  // namespace robocell
