#include "robocell/task/relation_task_config.h"

#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/scenes/relations.h"
#include "robocell/spec/validate.h"
#include "robocell/spec/yaml.h"
#include "robocell/spec/yaml_reader.h"
#include "robocell/spec/yaml_writer.h"
#include "robocell/task/held_relation.h"

namespace robocell {
namespace {

constexpr int kMostCubes = 6;
constexpr double kRegionRadius = 0.04;  // m, of models/equipment/region

void ValidateSentences(const char* field, const NameList& sentences, Problems& problems) {
  internal::RegisterTaskRelations();
  const Problems::Scope scope(problems, field);
  for (size_t i = 0; i < sentences.size(); ++i) {
    const Problems::Scope item(problems, i);
    try {
      ParseRelation(sentences[i]);
    } catch (const ArgumentError& error) {
      problems.Add(error.what());
    }
  }
}

}  // namespace

void RelationsTaskConfig::Validate(Problems& problems) const {
  ValidateSentences("start", start, problems);
  ValidateSentences("goal", goal, problems);
  if (goal.empty())
    problems.AddAt("goal", "is empty; write at least one relation, such as \"mug inside tray\"");
}

void StackTaskConfig::Validate(Problems& problems) const {
  if (cubes < 2 || cubes > kMostCubes)
    problems.AddAt("cubes", fmt::format("is {}; a stack has 2 to {} cubes", cubes, kMostCubes));
}

void OpenTaskConfig::Validate(Problems& problems) const {
  ValidateRange(start_opening, "start_opening", problems);
  if (start_opening[1] >= opening)
    problems.AddAt("start_opening", fmt::format("reaches {:g}, and the task is done from {:g} on "
                                                "(`opening`): leave something to open",
                                                start_opening[1], opening));
}

void CloseTaskConfig::Validate(Problems& problems) const {
  ValidateRange(start_opening, "start_opening", problems);
  if (start_opening[0] <= opening)
    problems.AddAt("start_opening", fmt::format("begins at {:g}, and the task is done from {:g} "
                                                "down (`opening`): leave something to close",
                                                start_opening[0], opening));
}

void PushTaskConfig::Validate(Problems& problems) const {
  ValidateRange(distance, "distance", problems);
  if (distance[0] <= kRegionRadius)
    problems.AddAt("distance", fmt::format("begins at {:g} m, within the region, whose radius is "
                                           "{:g} m",
                                           distance[0], kRegionRadius));
}

// The registry reads and writes the fields by name; these are for single structs.
template <>
std::string ToYaml(const RelationsTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
RelationsTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<RelationsTaskConfig>(text);
}
template <>
std::string ToYaml(const StackTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
StackTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<StackTaskConfig>(text);
}
template <>
std::string ToYaml(const PlaceNextToTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
PlaceNextToTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<PlaceNextToTaskConfig>(text);
}
template <>
std::string ToYaml(const OpenTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
OpenTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<OpenTaskConfig>(text);
}
template <>
std::string ToYaml(const CloseTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
CloseTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<CloseTaskConfig>(text);
}
template <>
std::string ToYaml(const PressTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
PressTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<PressTaskConfig>(text);
}
template <>
std::string ToYaml(const PushTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
PushTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<PushTaskConfig>(text);
}

}  // namespace robocell
