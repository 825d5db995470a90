// Checks that follow from the field declarations: finite numbers, ranges, and the Validate
// functions of nested specs.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "robocell/spec/containers.h"
#include "robocell/spec/element_ref.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/scene_source_spec.h"
#include "robocell/spec/types.h"

namespace robocell {

void ValidateNumber(double value, Bound bound, Problems& problems);

// Reports a value that is not an IsNamed one.
void ReportEnumNumber(int number, const std::vector<std::string>& names, Problems& problems);
template <HasEnumNames E>
void ValidateEnum(E value, Problems& problems) {
  if (!IsNamed(value)) ReportEnumNumber(static_cast<int>(value), ValueNames<E>(), problems);
}

void ValidateAttachTarget(const AttachTarget& target, Problems& problems);
void ValidateElementRef(const ElementRef& ref, Problems& problems);
// Reports a name with '/' or control characters, which cannot become part of names of columns and
// files.
void ValidateNamePart(const std::string& name, std::string_view field, Problems& problems);
// Checks degrees; the field's bound requires a positive number.
void ValidateFovy(const std::optional<double>& fovy, Problems& problems);
void ValidateNameList(const NameList& names, Problems& problems);

template <HasFields T>
void ValidateFields(const T& spec, Problems& problems);

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsOptional<Maybe<T>> : std::true_type {};
template <class T>
struct IsList : std::false_type {};
template <class T>
struct IsList<List<T>> : std::true_type {};
template <class T>
struct IsMap : std::false_type {};
template <class T>
struct IsMap<Map<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsArray : std::false_type {};
template <class T, size_t N>
struct IsArray<std::array<T, N>> : std::true_type {};

// One overload for every kind of field; values that are always valid by themselves fall through.
template <class T>
void ValidateValue(const T& value, Bound bound, Problems& problems) {
  if constexpr (std::is_floating_point_v<T> ||
                (std::is_integral_v<T> && !std::is_same_v<T, bool>)) {
    ValidateNumber(static_cast<double>(value), bound, problems);
  } else if constexpr (HasEnumNames<T>) {
    ValidateEnum(value, problems);
  } else if constexpr (IsOptional<T>::value) {
    if (value) ValidateValue(*value, bound, problems);
  } else if constexpr (IsList<T>::value || IsArray<T>::value || IsVector<T>::value) {
    for (size_t i = 0; i < value.size(); ++i) {
      problems.NameEntry(i, LabelOf(value[i]));
      Problems::Scope scope(problems, i);
      ValidateValue(value[i], bound, problems);
    }
  } else if constexpr (IsMap<T>::value) {
    for (const auto& [key, box] : value.entries()) {
      Problems::Scope scope(problems, key);
      ValidateValue(*box, bound, problems);
    }
  } else if constexpr (std::is_same_v<T, AttachTarget>) {
    ValidateAttachTarget(value, problems);
  } else if constexpr (std::is_same_v<T, ElementRef>) {
    ValidateElementRef(value, problems);
  } else if constexpr (std::is_same_v<T, SceneSourceSpec>) {
    ValidateScenes(value, problems);
  } else if constexpr (std::is_base_of_v<KindSpec, T>) {
    ValidateKind(value, problems);
  } else if constexpr (std::is_same_v<T, NameList>) {
    ValidateNameList(value, problems);
  } else if constexpr (HasFields<T>) {
    ValidateFields(value, problems);
  }
}

template <HasFields T>
void ValidateFields(const T& spec, Problems& problems) {
  ForEachField(spec, [&](const char* name, const auto& value, const char*, Bound bound) {
    Problems::Scope scope(problems, name);
    ValidateValue(value, bound, problems);
  });
  if constexpr (requires { spec.Validate(problems); }) spec.Validate(problems);
}

// Throws SpecError with all problems of `spec`; `what` names it ("scene 'pick'").
template <HasFields T>
void RequireValid(const T& spec, std::string_view what) {
  Problems problems;
  ValidateFields(spec, problems);
  problems.Throw(what);
}

// Reports an euler and a quat that are both set, and a quat that is not of unit length.
void ValidatePlacement(const Vec3& euler, const Vec4& quat, Problems& problems);
void ValidateUnitQuat(const Vec4& quat, Problems& problems);
// Reports a range whose lower end is above its upper end.
void ValidateRange(const Vec2& range, std::string_view field, Problems& problems);
// Reports names (or prefixes, by `what`) that two entries of a list share.
void ValidateUnique(const std::vector<std::string>& names, std::string_view list,
                    std::string_view what, Problems& problems);
// Reports an empty string.
void ValidateNotEmpty(const std::string& value, std::string_view field, std::string_view hint,
                      Problems& problems);

}  // namespace robocell
