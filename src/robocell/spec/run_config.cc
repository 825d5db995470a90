#include "robocell/spec/run_config.h"

#include <fmt/format.h>

#include <set>

#include "robocell/spec/validate.h"

namespace robocell {

void TaskConfig::Validate(Problems& problems) const {
  CheckRange(base_distance, "base_distance", problems);
  CheckRange(base_height_noise, "base_height_noise", problems);
}

SceneSourceKind SceneSource::kind() const {
  return source.value_or(files.empty() ? SceneSourceKind::kTabletop : SceneSourceKind::kFiles);
}

size_t SceneSource::count() const {
  if (!houses.empty()) return houses.size();
  return kind() == SceneSourceKind::kFiles ? files.size() : 1;
}

void SceneSource::Validate(Problems& problems) const {
  const bool from_files = kind() == SceneSourceKind::kFiles;
  if (from_files && files.empty()) {
    problems.AddAt("files", "`source: files` needs at least one MJCF file");
  }
  if (!from_files && !files.empty()) {
    problems.AddAt("files",
                   std::string("go with `source: files`; this source is ") + ToString(kind()));
  }
  std::set<int> seen;
  for (const int house : houses.values) {
    if (house < 0) problems.AddAt("houses", fmt::format("{} is negative", house));
    if (from_files && house >= static_cast<int>(files.size())) {
      problems.AddAt("houses", fmt::format("{} is outside the {} files (they count from 0)", house,
                                           files.size()));
    }
    if (!seen.insert(house).second) {
      problems.AddAt("houses", fmt::format("{} is listed twice", house));
    }
  }
}

void RunConfig::Validate(Problems& problems) const {
  CheckNotEmpty(run, "run", "the run's name", problems);
  CheckNotEmpty(output, "output", "the folder the dataset goes to", problems);
  if (robot.config == RobotConfig{}) {
    problems.AddAt("robot", "is required: a robot file, or the robot's fields");
  } else {
    Problems::Scope scope(problems, "robot");
    ValidateFields(robot.config, problems);
  }
}

}  // namespace robocell
