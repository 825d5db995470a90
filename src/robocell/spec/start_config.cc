#include "robocell/spec/start_config.h"

#include <algorithm>
#include <vector>

#include "robocell/spec/validate.h"

namespace robocell {

void StartConfig::Validate(Problems& problems) const {
  if (base_distance) ValidateRange(*base_distance, "base_distance", problems);
  if (base_height_noise) ValidateRange(*base_height_noise, "base_height_noise", problems);
}

std::string StartHint(const std::string& name) {
  const std::vector<std::string> names = FieldNames<StartConfig>();
  if (std::ranges::find(names, name) == names.end()) return "";
  return " It is a field of `start` of a run, for all tasks: start." + name;
}

}  // namespace robocell
