#include "robocell/task/pick_task_config.h"

#include "robocell/spec/task_spec.h"
#include "robocell/spec/yaml.h"
#include "robocell/spec/yaml_reader.h"
#include "robocell/spec/yaml_writer.h"

namespace robocell {

std::optional<PickRun> PickRunOf(const TaskSpec& task) {
  const auto run_of = [](const auto& pick) {
    return PickRun{.object = pick.object,
                   .objects = pick.objects,
                   .lift_height = pick.lift_height,
                   .arm = pick.arm};
  };
  if (const auto* pick = task.If<PickTaskConfig>()) return run_of(*pick);
  if (const auto* place = task.If<PickAndPlaceTaskConfig>()) return run_of(*place);
  return std::nullopt;
}

// The registry reads and writes the fields by name; these are for single structs.
template <>
std::string ToYaml(const PickTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
PickTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<PickTaskConfig>(text);
}
template <>
std::string ToYaml(const PickAndPlaceTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
PickAndPlaceTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<PickAndPlaceTaskConfig>(text);
}

}  // namespace robocell
