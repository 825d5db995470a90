#include "robocell/task/grasp.h"

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {

std::string ToString(GraspKind kind) {
  for (const auto& [value, name] : kGraspKinds) {
    if (value == kind) return std::string(name);
  }
  return "unknown";
}

GraspKind GraspKindOf(std::string_view name) {
  std::vector<std::string> names;
  for (const auto& [value, known] : kGraspKinds) {
    if (known == name) return value;
    names.emplace_back(known);
  }
  throw NotFoundError(NoSuchName("", "kind of grasp", std::string(name), names));
}

}  // namespace robocell
