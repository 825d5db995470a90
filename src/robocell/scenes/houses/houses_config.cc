// HousesScenes to and from YAML.
#include "robocell/scenes/houses/houses_config.h"

#include <string>
#include <string_view>

#include "robocell/spec/yaml.h"
#include "robocell/spec/yaml_reader.h"
#include "robocell/spec/yaml_writer.h"

namespace robocell {

void HousesScenes::Validate(Problems& problems) const {
  if (dataset && dataset->empty()) problems.AddAt("dataset", "is empty");
  if (root && root->empty()) problems.AddAt("root", "is empty");
  if (!dataset && !root && split)
    problems.AddAt("split", "the built-in houses have no splits; name a `dataset` or a `root`");
}

// The registry reads and writes the fields by name; these are for single structs.
template <>
std::string ToYaml(const HousesScenes& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
HousesScenes FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<HousesScenes>(text);
}

}  // namespace robocell
