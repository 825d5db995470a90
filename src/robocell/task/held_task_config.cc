#include "robocell/task/held_task_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "robocell/base/suggestions.h"
#include "robocell/spec/validate.h"
#include "robocell/spec/yaml.h"
#include "robocell/spec/yaml_reader.h"
#include "robocell/spec/yaml_writer.h"
#include "robocell/task/held_tasks.h"

namespace robocell {
namespace {

constexpr int kMostSorted = 6;
constexpr int kLeastGrains = 20, kMostGrains = 200;
constexpr double kWidestClearance = 0.01;  // m
constexpr double kNearestArea = 0.12;      // m: the sponge is beside the area

void RequireSome(double share, const char* field, Problems& problems) {
  if (share == 0) problems.AddAt(field, "0 holds at every start; give a share above 0");
}

}  // namespace

void InsertTaskConfig::Validate(Problems& problems) const {
  RequireSome(depth, "depth", problems);
  if (clearance > kWidestClearance)
    problems.AddAt("clearance",
                   fmt::format("is {:g} m; at most {:g} m makes sense for holes of "
                               "{:g} m",
                               clearance, kWidestClearance, internal::InsertTask::kHoleWidth));
  const Problems::Scope scope(problems, "shapes");
  const std::vector<std::string> known = internal::InsertTask::AllShapes();
  for (size_t i = 0; i < shapes.size(); ++i) {
    if (std::ranges::find(known, shapes[i]) != known.end()) continue;
    const Problems::Scope item(problems, i);
    problems.Add(NoSuchName("", "shape", shapes[i], known));
  }
}

void SortTaskConfig::Validate(Problems& problems) const {
  if (objects < 2 || objects > kMostSorted)
    problems.AddAt("objects", fmt::format("is {}; 2 to {} cubes are sorted", objects, kMostSorted));
}

void WipeTaskConfig::Validate(Problems& problems) const {
  RequireSome(share, "share", problems);
  ValidateRange(distance, "distance", problems);
  if (distance[0] < kNearestArea)
    problems.AddAt("distance",
                   fmt::format("begins at {:g} m, and the sponge is beside the area from "
                               "{:g} m on",
                               distance[0], kNearestArea));
}

void PourTaskConfig::Validate(Problems& problems) const {
  RequireSome(share, "share", problems);
  if (grains < kLeastGrains || grains > kMostGrains)
    problems.AddAt("grains", fmt::format("is {}; a vessel has {} to {} grains", grains,
                                         kLeastGrains, kMostGrains));
}

template <>
std::string ToYaml(const InsertTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
InsertTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<InsertTaskConfig>(text);
}
template <>
std::string ToYaml(const SortTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
SortTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<SortTaskConfig>(text);
}
template <>
std::string ToYaml(const WipeTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
WipeTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<WipeTaskConfig>(text);
}
template <>
std::string ToYaml(const PourTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
PourTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<PourTaskConfig>(text);
}

}  // namespace robocell
