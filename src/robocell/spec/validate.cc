#include "robocell/spec/validate.h"

#include <map>
#include <set>

#include <fmt/format.h>

#include "robocell/base/paths.h"
#include "robocell/base/suggestions.h"

namespace robocell {

namespace {

// Describes the valid values of a field with this bound.
const char* Wanted(Bound bound) {
  switch (bound) {
    case Bound::kPositive:
      return "a number greater than 0";
    case Bound::kNonNegative:
      return "0 or a greater number";
    case Bound::kFraction:
      return "a number between 0 and 1";
    default:
      return "a number";
  }
}

}  // namespace

void ValidateNumber(double value, Bound bound, Problems& problems) {
  if (!std::isfinite(value)) {
    problems.Add(
        fmt::format("{} is not a finite number; write {} in its place", value, Wanted(bound)));
  } else if (bound == Bound::kPositive && value <= 0) {
    problems.Add(fmt::format("{} must be greater than 0", value));
  } else if (bound == Bound::kNonNegative && value < 0) {
    problems.Add(fmt::format("{} must not be negative", value));
  } else if (bound == Bound::kFraction && (value < 0 || value > 1)) {
    problems.Add(fmt::format("{} must lie between 0 and 1", value));
  }
}

void ValidateUnitQuat(const Vec4& quat, Problems& problems) {
  const double norm =
      std::sqrt(quat[0] * quat[0] + quat[1] * quat[1] + quat[2] * quat[2] + quat[3] * quat[3]);
  if (std::isfinite(norm) && std::abs(norm - 1) > 1e-6) {
    problems.AddAt(
        "quat",
        fmt::format("[{}, {}, {}, {}] has length {:.6g}, a rotation needs 1 (order is x, y, z, w)",
                    quat[0], quat[1], quat[2], quat[3], norm));
  }
}

void ValidatePlacement(const Vec3& euler, const Vec4& quat, Problems& problems) {
  ValidateUnitQuat(quat, problems);
  if (quat != kIdentityQuat && euler != Vec3{}) {
    problems.AddAt("quat", "both quat and euler are set; keep one of them");
  }
}

void ReportEnumNumber(int number, const std::vector<std::string>& names, Problems& problems) {
  problems.Add(fmt::format("there is no value {}; expected one of {}", number, ListNames(names)));
}

void ValidateAttachTarget(const AttachTarget& target, Problems& problems) {
  if (!IsNamed(target.kind)) return ValidateEnum(target.kind, problems);
  const std::string kind = ToString(target.kind);
  const bool named = target.kind != AttachKind::kWorld && target.kind != AttachKind::kRoot &&
                     target.kind != AttachKind::kSharedBase;
  if (named && target.name.empty()) {
    problems.Add("which " + kind + "? Its name is missing; write {" + kind + ": name}");
  }
  if (!named && !target.name.empty()) {
    problems.Add("'" + kind + "' is a separate frame and takes no name; '" + target.name +
                 "' looks like one, is it a body or site?");
  }
}

void ValidateElementRef(const ElementRef& ref, Problems& problems) {
  if (ref.name.empty() && ref.body.empty()) {
    problems.Add("names no element; write its name, or {body: name, index: 0} if it has none");
  }
  if (!ref.name.empty() && !ref.body.empty()) {
    problems.Add(fmt::format("has both a name ('{}') and a place (body '{}'); keep one of them",
                             ref.name, ref.body));
  }
  if (ref.index < 0) {
    problems.Add(fmt::format("index {} is negative; the first is 0", ref.index));
  }
}

void ValidateNamePart(const std::string& name, std::string_view field, Problems& problems) {
  if (name.empty() || internal::ValidFileName(name)) return;
  problems.AddAt(field,
                 fmt::format("'{}' cannot be a name here: datasets have it in their columns' "
                             "names, robots/ROBOT/GROUP and objects/OBJECT; write it without "
                             "'/' and control characters",
                             name));
}

void ValidateFovy(const std::optional<double>& fovy, Problems& problems) {
  if (fovy && *fovy >= 180)
    problems.AddAt("fovy", fmt::format("{} degrees is not below 180", *fovy));
}

void ValidateNameList(const NameList& list, Problems& problems) {
  std::set<std::string> seen;
  for (const std::string& name : list) {
    if (name.empty()) problems.Add("holds an empty name");
    if (!seen.insert(name).second) problems.Add("'" + name + "' is listed twice");
  }
}

void ValidateRange(const Vec2& range, std::string_view field, Problems& problems) {
  if (range[0] > range[1]) {
    problems.AddAt(field, fmt::format("[{}, {}] is [smallest, largest]; the first is larger",
                                      range[0], range[1]));
  }
}

void ValidateUnique(const std::vector<std::string>& names, std::string_view list,
                    std::string_view what, Problems& problems) {
  std::map<std::string, size_t> first;
  Problems::Scope scope(problems, list);
  for (size_t i = 0; i < names.size(); ++i) {
    const auto [it, added] = first.emplace(names[i], i);
    if (added) continue;
    const std::string other = fmt::format("{}[{}]", problems.path(), it->second);
    Problems::Scope item(problems, i);
    const bool is_prefix = what == "prefix";
    problems.Add(fmt::format("{} '{}' is also that of {}; each needs its own{}", what, names[i],
                             is_prefix ? problems.Shown(other)  // by its name, not seen in `names`
                                       : fmt::format("{}[{}]", list, it->second),
                             is_prefix ? ", for example `prefix: right_`" : ""));
  }
}

void ValidateNotEmpty(const std::string& value, std::string_view field, std::string_view hint,
                      Problems& problems) {
  if (value.empty()) problems.AddAt(field, "is required: " + std::string(hint));
}

}  // namespace robocell
